"""Results of earlier driving on disk: taken again as long as nothing that they depend on has changed."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from ev_msgs_py.compiling.machine_code import age
from ev_msgs_py.compiling.user_cache import cache_folder, read_checked, write_checked
from ev_sim.running.recording.recording import Recording, load, save
from ev_sim.running.scenarios.scenario import Run
from ev_sim.study.case import Case, CaseResult, Measure
from ev_sim.study.depends import NEVER_DRIVES, case_key, digest_of_sources
from ev_sim.study.kept_rows import as_json, result_of

_ONLY_JUDGES = (*NEVER_DRIVES, "ev_sim/verdicts", "ev_sim/report/figures")
_ONLY_MEASURES = ("ev_sim/report", "ev_sim/study")
_DIGEST = "[0-9a-f]" * 24
_FOLDERS = 3  # of each kind: those of other checkouts and branches come back


@dataclass(frozen=True, slots=True)
class Keep:
    """What a worker does with the signals of a run of a scenario: it writes them where they are looked for."""

    path: Path

    def __call__(self, recording: Recording, run: Run) -> Mapping[str, Any]:
        with suppress(FileExistsError):  # another command has driven the same meanwhile
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
    write_checked(path, json.dumps(as_json(result)).encode())


class Kept:
    """A folder with recordings of scenarios and with what studies have measured.

    Files stand under a digest of all sources, configuration files and versions of packages they depend on; what was
    kept of other sources is removed, but for that which was asked for last.
    """

    def __init__(self, folder: Path) -> None:
        self._recordings = folder / f"recordings_{digest_of_sources(_ONLY_JUDGES + _ONLY_MEASURES, config=True)}"
        self._measured = folder / f"measured_{digest_of_sources(_ONLY_JUDGES, config=True)}"
        for each in (self._recordings, self._measured):
            each.mkdir(parents=True, exist_ok=True)
            os.utime(each)
            ours = folder.glob(f"{each.name.partition('_')[0]}_{_DIGEST}")
            others = sorted(ours, key=age)
            for other in others[_FOLDERS:]:
                for file in (*other.glob("*.npz"), *other.glob("*.json")):
                    file.unlink(missing_ok=True)  # another command may be doing the same
                with suppress(OSError):  # what we have not written stays
                    other.rmdir()

    def recording(self, case: Case) -> Path:
        """Where the signals of a case are, or have to be written."""
        return self._recordings / f"{case_key(case)}.npz"

    def measured(self, study: str, case: Case) -> Path:
        """Where what a study has measured on a case is, or has to be written."""
        return self._measured / f"{study}_{case_key(case)}.json"


def kept_by_user() -> Kept:
    """What stands in the cache folder of the user, for all checkouts."""
    return Kept(cache_folder() / "verdicts")


def measured_at(path: Path, name: str) -> CaseResult | None:
    """What a study has measured on a case, which is called by this name; None if it has not yet."""
    kept = read_checked(path)
    return None if kept is None else result_of(json.loads(kept), name)


@lru_cache(maxsize=6)  # one of a whole cycle has 80 MB
def recording_at(path: Path) -> Recording:
    """The signals in a file; the last ones stay in memory."""
    return load(path)
