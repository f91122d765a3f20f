"""Runs of scenarios without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

import time

from ev_sim.recording.offline import load_compiled, run_offline
from ev_sim.recording.outcome import Outcome, Progress
from ev_sim.scenarios.scenario import Run


def drive_offline(run: Run, progress: Progress = lambda time: None) -> Outcome:
    """Drive one run of a scenario; raises what `run_offline` does. To compile does not count as driving."""
    load_compiled(run.configurations)
    start = time.monotonic()
    notes: list[str] = []
    recording = run_offline(
        run.configurations, run.duration, progress, lambda role, text: notes.append(f"{run.namespace}/{role}: {text}")
    )
    return Outcome(recording, time.monotonic() - start, notes=tuple(notes))
