"""Results of earlier driving on disk: taken again as long as nothing that they depend on has changed."""

from __future__ import annotations

import pickle
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from ev_sim.running.recording.atomic import atomic_file
from ev_sim.running.recording.recording import Recording, load, save
from ev_sim.running.scenarios.scenario import Run
from ev_sim.study.case import Case, CaseResult, Measure
from ev_sim.study.depends import NEVER_DRIVES, case_key, digest_of_sources

_ONLY_MEASURES = ("ev_sim/report", "ev_sim/study")


@dataclass(frozen=True, slots=True)
class Keep:
    """What a worker does with the signals of a run of a scenario: it writes them where they are looked for."""

    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        save(recording, self.path)
        return {}


@dataclass(frozen=True, slots=True)
class KeepMeasured:
    """What a worker does with the case of a study: it measures and writes, so that what is done outlives a stop."""

    path: Path
    measure: Measure

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        measured = self.measure(recording, run)
        keep(CaseResult("", measured), self.path)
        return measured


def keep(result: CaseResult, path: Path) -> None:
    """Write what a study has measured on a case, or why it was refused."""
    with atomic_file(path, replaces=True) as file:
        pickle.dump(result, file)


class Kept:
    """A folder with recordings of scenarios and with what studies have measured.

    Files stand under a digest of all sources, configuration files and versions of packages they depend on; what
    other sources left there is removed.
    """

    def __init__(self, folder: Path) -> None:
        self._recordings = folder / f"recordings_{digest_of_sources(NEVER_DRIVES + _ONLY_MEASURES)}"
        self._measured = folder / f"measured_{digest_of_sources(NEVER_DRIVES)}"
        for each in (self._recordings, self._measured):
            for other in folder.glob(each.name.partition("_")[0] + "_*"):
                if other != each:
                    shutil.rmtree(other)
            each.mkdir(parents=True, exist_ok=True)

    def recording(self, case: Case) -> Path:
        """Where the signals of a case are, or have to be written."""
        return self._recordings / f"{case_key(case)}.npz"

    def measured(self, study: str, case: Case) -> Path:
        """Where what a study has measured on a case is, or has to be written."""
        return self._measured / f"{study}_{case_key(case)}.pickle"


def measured_at(path: Path, name: str) -> CaseResult:
    """What a study has measured on a case of this name."""
    return replace(pickle.loads(path.read_bytes()), name=name)


@lru_cache(maxsize=6)  # one of a whole cycle has 80 MB
def recording_at(path: Path) -> Recording:
    """The signals in a file; the last ones stay in memory."""
    return load(path)
