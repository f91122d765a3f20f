"""The folder that a scenario leaves behind."""

from __future__ import annotations

import shutil
from pathlib import Path

from ev_msgs_py.parameters import ParameterError
from ev_sim.scenario.scenario import Run, Scenario

_OF_A_SCENARIO = ("summary.json",)
_OF_A_RUN = ("bag", "log", "signals.npz", "parameters.yaml")


class OutputFolder:
    """`--out DIR`: summary.json and figures in DIR; bag, signals and parameters of each run beside or below.

    A single run writes into DIR itself, several runs into DIR/RUN. What an earlier run of a scenario left there is
    replaced, anything else is not touched. ParameterError if DIR cannot be made.
    """

    def __init__(self, directory: Path, scenario: Scenario) -> None:
        self.directory = directory.absolute()
        self._alone = len(scenario.runs) == 1
        folders = {self.directory, *(self.of(run) for run in scenario.runs)}
        try:
            for folder in sorted(folders):
                folder.mkdir(parents=True, exist_ok=True)
                for name in _OF_A_RUN + _OF_A_SCENARIO:
                    _remove(folder / name)
                for figure in folder.glob("*.png"):
                    figure.unlink()
        except OSError as error:
            raise ParameterError(f"--out {directory}: {error.strerror}") from None

    def of(self, run: Run) -> Path:
        """The folder of one run."""
        return self.directory if self._alone else self.directory / run.name


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
