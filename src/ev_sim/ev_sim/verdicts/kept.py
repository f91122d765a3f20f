"""Results of earlier driving on disk: taken again as long as nothing that they depend on has changed."""

from __future__ import annotations

import hashlib
import pickle
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

from ev_msgs_py.parameters.config_directory import config_directory
from ev_sim.report.summary import versions
from ev_sim.run.recording.atomic import atomic_file
from ev_sim.run.recording.recording import Recording, load, save
from ev_sim.run.scenarios.scenario import Run
from ev_sim.study.case import Case, CaseResult

_PACKAGES = ("ev_msgs_py", "ev_control", "ev_sim")
_NEVER_DRIVES = ("ev_sim/commands", "ev_sim/verdicts", "ev_sim/report/figures", "ev_sim/report/scenarios")
_ONLY_MEASURES = ("ev_sim/report", "ev_sim/study")


@dataclass(frozen=True, slots=True)
class Keep:
    """What a worker does with the signals of a run of a scenario: it writes them where they are looked for."""

    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        save(recording, self.path)
        return {}


class Kept:
    """A folder with recordings of scenarios and with what studies have measured.

    Files stand under a digest of all sources, configuration files and versions of packages they depend on; what
    other sources left there is removed.
    """

    def __init__(self, folder: Path) -> None:
        self._recordings = folder / f"recordings_{_digest(_NEVER_DRIVES + _ONLY_MEASURES)}"
        self._measured = folder / f"measured_{_digest(_NEVER_DRIVES)}"
        for each in (self._recordings, self._measured):
            for other in folder.glob(each.name.partition("_")[0] + "_*"):
                if other != each:
                    shutil.rmtree(other)
            each.mkdir(parents=True, exist_ok=True)

    def recording(self, case: Case) -> Path:
        """Where the signals of a case are, or have to be written."""
        return self._recordings / f"{_key(case)}.npz"

    def measured(self, study: str, case: Case) -> CaseResult | None:
        """What a study has measured on a case, None if that is not known yet."""
        path = self._measured / f"{study}_{_key(case)}.pickle"
        return pickle.loads(path.read_bytes()) if path.exists() else None

    def keep(self, study: str, case: Case, result: CaseResult) -> None:
        """Write what a study has measured on a case."""
        with atomic_file(self._measured / f"{study}_{_key(case)}.pickle") as file:
            pickle.dump(result, file)


@lru_cache(maxsize=6)  # one of a whole cycle has 80 MB
def recording_at(path: Path) -> Recording:
    """The signals in a file; the last ones stay in memory."""
    return load(path)


def _key(case: Case) -> str:
    said = repr((case.scenario, case.values, case.run, [str(file) for file in case.files], case.duration))
    return hashlib.sha256(said.encode()).hexdigest()[:24]


def _digest(without: tuple[str, ...]) -> str:
    digest = hashlib.sha256(repr(sorted(versions().items())).encode())
    for name, path in sorted(_files(without)):
        digest.update(f"{name}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:24]


def _files(without: tuple[str, ...]) -> Iterable[tuple[str, Path]]:
    for package in _PACKAGES:
        top = Path(import_module(package).__file__ or "").parent.parent
        for path in (top / package).rglob("*.py"):
            name = path.relative_to(top).as_posix()
            if not name.startswith(tuple(f"{each}/" for each in without)):
                yield name, path
    config = config_directory()
    for path in config.rglob("*"):
        if path.is_file() and "published" not in path.relative_to(config).parts:
            yield f"config/{path.relative_to(config).as_posix()}", path
