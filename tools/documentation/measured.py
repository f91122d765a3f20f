"""What long studies have measured, kept beside docs/verdicts.md: tests hold its rows against all cases and drive few.

docs/measured/STUDY.json has all numbers of every case. A test computes the verdicts from them, and
drives some of the cases anew, whose numbers must be those of the file.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from ev_study.studies.run_study import arguments
from ev_study.studies.study import Case, CaseResult
from ev_study.verdicts.need import StudyCases, StudyNeed, cases_of

ROOT = Path(__file__).parents[2]
FOLDER = "docs/measured"
LONG = 40  # cases, from which on a study is too long to be driven in a test
SAMPLE = 2  # cases of a long study that a test drives


@cache
def is_long(need: object) -> bool:
    """Whether tests take the numbers of a study from its file."""
    return isinstance(need, StudyNeed) and len(cases_of(need)) >= LONG


def write_measured(root: Path, need: StudyNeed, driven: StudyCases) -> None:
    """Write what a study has measured."""
    path = _path(root, need)
    path.parent.mkdir(exist_ok=True)
    cases = {name: _numbers(result.measured) for name, result in driven.results.items()}
    lines = ",\n".join(
        f"{json.dumps(name)}: {json.dumps(numbers, allow_nan=False)}"
        for name, numbers in cases.items()
    )
    path.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")


def read_measured(root: Path, need: StudyNeed) -> StudyCases:
    """What a study has measured, from its file."""
    cases = json.loads(_path(root, need).read_text(encoding="utf-8"))
    results = {name: CaseResult(name, measured) for name, measured in cases.items()}
    return StudyCases(results, arguments(need.study, need.options))


def sample(need: StudyNeed) -> list[Case]:
    """Some cases of a study, evenly spread."""
    cases = cases_of(need)
    return cases[:: math.ceil(len(cases) / SAMPLE)]


def _numbers(measured: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: value
        for name, value in measured.items()
        if isinstance(value, str | int | float | bool | None)
    }


def _path(root: Path, need: StudyNeed) -> Path:
    words = re.sub(r"\W+", "_", need.command).strip("_")
    return root / FOLDER / f"{words}.json"
