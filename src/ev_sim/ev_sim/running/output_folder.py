"""The folder that a scenario leaves behind."""

from __future__ import annotations

import fcntl
import os
import shutil
import weakref
from collections.abc import Sequence
from pathlib import Path

from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.running.files_of_run import BAG, PARAMETERS, SIGNALS
from ev_sim.running.scenarios.scenario import Run

_OF_A_SCENARIO = ("summary.json", "report.html", "table.csv", "table.md", "table.tex", "table.parquet")
_OF_A_RUN = (BAG, f"{BAG}_before_reset_*", "log", SIGNALS, PARAMETERS)
_FIGURES = ("*.png", "*.pdf", "*.svg")
_MARKS = ("summary.json", PARAMETERS)  # what a run leaves behind, first and last


class OutputFolder:
    """`--out DIR`: summary.json and figures in DIR; bag, signals and parameters of each run beside or below.

    A single run writes into DIR itself, several runs into DIR/RUN, a study keeps no runs. What an earlier run of a
    scenario left there is replaced, anything else is not touched. ParameterError if DIR cannot be made, or holds
    something of the same name that no run has left there, or if another run is writing there: the folder is locked for
    as long as this object lives.
    """

    def __init__(self, directory: Path, runs: Sequence[Run]) -> None:
        self.directory = directory.absolute()
        self._alone = len(runs) == 1
        folders = {self.directory, *(self.of(run) for run in runs)}
        try:
            for folder in sorted(folders):
                folder.mkdir(parents=True, exist_ok=True)
                self._lock(folder)
            for folder in sorted(folders):
                self._clear(folder)
        except OSError as error:
            raise ParameterError(f"--out {directory}: {error.strerror}") from None

    def _lock(self, folder: Path) -> None:
        held = os.open(folder, os.O_RDONLY)
        weakref.finalize(self, os.close, held)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ParameterError(f"--out {folder}: another run is writing there, allowed is another folder") from None

    def _clear(self, folder: Path) -> None:
        found = [path for pattern in _OF_A_RUN + _OF_A_SCENARIO for path in sorted(folder.glob(pattern))]
        if any((folder / mark).exists() for mark in _MARKS):
            for path in (*found, *(each for kind in _FIGURES for each in folder.glob(kind))):
                _remove(path)
        elif found:
            names = ", ".join(path.name for path in found)
            raise ParameterError(f"--out {folder}: {names} there is not of an earlier run, allowed is another folder")

    def of(self, run: Run) -> Path:
        """The folder of one run."""
        return self.directory if self._alone else self.directory / run.name


def forget_recording(directory: Path) -> None:
    """Remove what the recorder of a run has written into its folder, so that another one may begin there."""
    for name in (BAG, SIGNALS):
        if (directory / name).exists():
            _remove(directory / name)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink()
