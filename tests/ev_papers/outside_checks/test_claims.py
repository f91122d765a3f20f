"""Outside checks: what is driven, how it is counted, and that each verdict can fail."""

from __future__ import annotations

import dataclasses
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest

from documentation.measured import read_measured
from ev_papers.outside_checks import friction, lap, laws
from ev_papers.outside_checks.cases import DRAWS, drawn, interval, measure
from ev_study.studies.study import drive_case, run_of
from ev_study.verdicts.need import StudyCases, StudyNeed
from ev_study.verdicts.sources import published
from ev_study.verdicts.verdict import verdict

ROOT = Path(__file__).parents[3]
CLAIMS = published("outside_checks")


def judged(id: str, changed=None) -> str:
    """Verdict from the measured numbers, some replaced by `changed`: (name, quantity)."""
    kept = read_measured(ROOT, CLAIMS[id].needs[0])
    results = {
        name: dataclasses.replace(
            of, measured={q: changed(name, q, value) for q, value in of.measured.items()}
        )
        if changed
        else of
        for name, of in kept.results.items()
    }
    return verdict(CLAIMS[id], [StudyCases(results, kept.given)]).judgement


@pytest.mark.parametrize(
    ("id", "law", "factor"),
    [
        ("novellis.understeer", " ramp truth suboptimal:", 0.85),  # as without a law
        ("novellis.pid", " truth pi:", 10.0),
        ("novellis.sideslip", " pi + sideslip 1.5:", 10.0),
        ("novellis.sideslip", " truth suboptimal 1.5:", 0.1),  # nothing to save
        ("asperti.open_loop", " truth lqr:", 100.0),
        ("asperti.closed_loop", " truth suboptimal:", 100.0),
        ("asperti.estimation", " estimated pi:", 0.1),
    ],
)
def test_other_numbers_are_noticed(id: str, law: str, factor: float):
    assert judged(id) == "reproduced"
    assert (
        judged(id, lambda name, _, value: value * factor if law in name else value)
        == "not reproduced"
    )


def test_sliding_modes_that_slide_less_would_reproduce_the_order():
    assert judged("novellis.friction") == "not reproduced"
    modes = (" truth super_twisting 1.5:", " truth suboptimal 1.5:")
    assert judged(
        "novellis.friction",
        lambda name, _, value: value / 2 if any(m in name for m in modes) else value,
    ) == ("reproduced")


def test_a_car_that_leaves_the_course_no_faster_than_by_the_fixed_split_gains_nothing():
    """No lap of the law counts above a scale of 0.87, where none with equal torques is clean."""

    def slower(name: str, quantity: str, value: object) -> object:
        law, scale = name.partition(": ")[0].rsplit(" ", 1)
        return (
            None
            if quantity == "lap_time" and law.endswith("least_squares") and float(scale) > 0.87
            else value
        )

    assert judged("broere.lap") == "in part"  # not with the best brakes of each
    assert judged("broere.lap", slower) == "not reproduced"


def test_a_lap_is_driven_by_the_drawn_friction_and_scale():
    """21 scales, 5 draws, 4 + 1 + 5 times 2 laws; the driver knows the friction of the draw."""
    cases = {case.name: case for case in lap.cases(Namespace())}
    assert len(cases) == 21 * 5 * 15
    given = run_of(
        cases["all accelerates less truth pi_neutral_least_squares 0.90: 2"]
    ).configurations
    driver, law = (given[role].values() for role in ("driver", "electronic_differential"))
    assert (driver["limit.scale"], driver["limit.driving"]) == (0.9, 0.6)
    assert driver["limit.friction"] == drawn()["friction"][2]
    assert (law["controller"], law["reference"], law["allocation"]) == (
        "pi",
        "neutral",
        "least_squares",
    )


def test_draws_are_the_same_for_all_laws_and_the_given_friction_is_the_laws_alone():
    """All but what the differential is given.

    Ten draws of 5 cells, 6 laws, 5 factors, and equal torques.
    """
    cases = friction.cases(Namespace())
    assert len(cases) == DRAWS * (5 * 6 * 5 + 4) == 1540
    of = {
        case.name: [value for value in case.values if value[0] != "electronic_differential"]
        for case in cases
    }
    assert of["all wet truth pi 0.5: 3"] == of["all wet estimated suboptimal + sideslip 1.5: 3"]
    assert of["all wet truth pi 0.5: 3"] != of["all wet truth pi 0.5: 4"]
    (case,) = (
        case for case in cases if case.name == "all wet estimated suboptimal + sideslip 1.5: 3"
    )
    given = run_of(case).configurations["electronic_differential"].values()
    assert (given["reference"], given["controller"], given["estimation"], given["known.error_factor"]) == (
        "sideslip_limit", "suboptimal", "estimated", 1.5,
    )  # fmt: skip


def test_wrong_tyres_are_what_a_law_believes_and_not_what_the_car_has():
    right, wrong = (
        {case.name: case for case in laws.cases(Namespace())}[f"all step {known} pi: 0"]
        for known in ("truth", "truth, wrong tyres")
    )
    apart = {name for (node, name, value) in set(right.values) ^ set(wrong.values)}
    groups = ("single_track", "known.observer")
    assert apart == {
        f"{group}.{axle}_cornering_stiffness" for group in groups for axle in ("front", "rear")
    }


def test_super_twisting_tracks_the_designed_yaw_rate_on_a_ramp():
    """Within 1 mrad/s, where the car without a law is 10 mrad/s away.

    The error is that to the law's own reference.
    """
    cases = {case.name: case for case in laws.cases(Namespace())}
    errors = {
        law: drive_case(cases[f"all ramp {law}: 1"], measure).measured["tracking"]
        for law in ("equal_torque", "truth super_twisting")
    }
    assert errors["truth super_twisting"] < 0.001 < 0.01 < errors["equal_torque"]


def test_interval_of_the_median_is_seeded_and_holds_it():
    values = np.arange(10.0)
    middle, low, high = interval(values)
    assert (middle, low, high) == interval(values)
    assert low < middle == 4.5 < high


def test_studies_are_judged_from_their_files():
    assert all(
        isinstance(need, StudyNeed) and need.slow for of in CLAIMS.values() for need in of.needs
    )
