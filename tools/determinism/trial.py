"""Drive one run in one way and print the hash of its signals.

python -m determinism.trial SCENARIO RUN SECONDS CHANGES WAY, the changes as JSON.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from determinism.faults import run_with
from determinism.surroundings import WAYS
from ev_stack.recording.offline import run_offline
from ev_stack.recording.outcome import Outcome
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.records import Run


def driven(run: Run, way: str) -> Recording:
    """The signals of a run that is driven in one of the ways."""
    if way == WAYS[0]:
        return run_offline(run.configurations, run.duration)
    drive: Callable[..., Outcome] = run_in_process if way == WAYS[1] else run_in_processes
    with tempfile.TemporaryDirectory(prefix="ev_stack_determinism_") as folder:
        return drive(run, Path(folder), False, lambda time: None).recording


def main(argv: list[str]) -> None:
    """Print the hash of the run that the words name."""
    scenario, name, seconds, changes, way = argv
    print(signal_hash(driven(run_with(scenario, name, float(seconds), json.loads(changes)), way)))


if __name__ == "__main__":
    main(sys.argv[1:])
