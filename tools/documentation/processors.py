"""The table of docs/determinism.md: every run as an exported program on several processors, against its hash."""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from documentation.hashes import Hashes
from documentation.markdown import code, table
from ev_doors.export.content import Content
from ev_doors.export.program import Program, build_program
from ev_doors.export.targets import TARGETS, Target
from ev_msgs_py.contract import frame, stamps
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario

PROCESSORS = "docs/determinism.md"
BLOCK = "processors"
DRIVEN = ("x86_64-linux", "aarch64-linux", "arm-linux")


def hash_on(run: Run, target: Target, objects: Path) -> str:
    """The signal hash of a run of an exported program; object files are kept in a folder for later runs."""
    content = Content(run)
    steps = stamps.from_seconds(run.duration) // run.period
    with Program(content, build_program(content, target, objects)) as program:
        rows = program.drive(steps)
    channels = {channel.name: rows[:, n] for n, channel in enumerate(content.outputs)}
    return signal_hash(Recording(frame.times(steps + 1, run.period), channels))


def processor_table(published: Hashes) -> str:
    """A row for each run; one that differs from its published hash shows its own."""
    refuse_missing()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for (scenario, name), digits in published.items():
            (run,) = load_scenario(scenario, only=[name]).runs
            found = []
            for target in DRIVEN:
                objects = Path(folder, target)
                objects.mkdir(exist_ok=True)
                here = hash_on(run, TARGETS[target], objects)[: len(digits)]
                found.append("equal" if here == digits else code(here))
            rows.append([code(scenario), code(name), *found])
            print(" ".join(rows[-1]), file=sys.stderr, flush=True)
    return table(("scenario", "run", *DRIVEN), rows)


def refuse_missing(*words: str) -> None:
    """End with a line if a compiler, an emulator or one of these words is not installed."""
    needed = [
        word for name in DRIVEN for word in (TARGETS[name].compiler, *TARGETS[name].emulator[:1])
    ]
    if lacking := [word for word in (*needed, *words) if not shutil.which(word)]:
        sys.exit(f"not installed: {', '.join(lacking)} (docs/native.md)")
