"""What the threads of a run that does not end are doing, for whoever has to find out why."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

_PATIENCE = 60.0  # s for one process


def keep_stacks(processes: Mapping[int, str], folder: Path) -> None:
    """Write the stacks of all threads of processes, by id and name, into a folder; nothing where there is no gdb."""
    debugger = shutil.which("gdb")
    if debugger is None:
        return
    for process, name in processes.items():
        with (
            suppress(subprocess.TimeoutExpired),
            (folder / f"stacks_{name}_{process}.txt").open("w") as place,
        ):
            words = [debugger, "-p", str(process), "-batch", "-ex", "thread apply all backtrace"]
            subprocess.run(
                words, stdout=place, stderr=subprocess.DEVNULL, timeout=_PATIENCE, check=False
            )
