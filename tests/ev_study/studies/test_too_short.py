"""Runs too short to be measured: one line, never a traceback behind the driving."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.outcome import RunFailed
from ev_study.studies.run_study import _summed_up, arguments
from ev_study.studies.study import drive_case, study_named, study_names

pytestmark = pytest.mark.slow
NEEDED = {
    "energy": (str(Path(__file__).with_name("electric_cars.csv")),),
    "sweep": ("--seeds", "2"),
}


@pytest.mark.sampled
@pytest.mark.parametrize("name", study_names())
def test_runs_that_are_too_short_have_one_line(name):
    """All studies, shorter than the command line lets them be.

    Each case has a row or says why it has none.
    """
    study, given = study_named(name), arguments(name, NEEDED.get(name, ()))
    cases = study.cases(given)
    result = drive_case(replace(cases[0], duration=0.05), study.measure)
    assert "\n" not in result.refused and bool(result.refused) != bool(
        result.measured or name in CYCLES
    )
    results = {case.name: replace(result, name=case.name) for case in cases}
    try:
        found = _summed_up(study, given, results)
    except (ParameterError, RunFailed) as error:
        assert "\n" not in str(error)
    else:
        assert isinstance(found.text, str)
        json.dumps(
            {key: metric.as_json() for key, metric in found.metrics.items()}, allow_nan=False
        )


# of which a part without traction has no numbers, and is no mistake
CYCLES = ("five_methods", "urban_sensitivity")
