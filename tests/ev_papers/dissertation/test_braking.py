"""The study of braking.

What an ABS is worth, what the drives add to it, and that traction controls are none.
"""

from __future__ import annotations

import argparse

import pytest

from ev_papers.dissertation.studies import braking
from ev_study.studies.study import CaseResult, drive_case

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def results() -> dict[str, CaseResult]:
    roads = ["wet", "dry, then snow"]
    return {
        case.name: drive_case(case, braking.measure)
        for case in braking.cases(argparse.Namespace(roads=roads))
    }


def test_a_traction_control_leaves_braking_alone(results):
    """The same signals to the bit as without any."""
    for road in ("wet", "dry, then snow"):
        assert results[f"{road}: least_squares"].signal_hash == results[f"{road}: off"].signal_hash


@pytest.mark.parametrize("road", ["wet", "dry, then snow"])
def test_abs_stops_the_car_in_less(road, results):
    """Locked wheels have 0.69 of the friction on wet asphalt and 0.6 on snow.

    At a slip of 0.1 at least 0.95.
    """
    for name in ("friction", "drives", "stability"):
        assert (
            results[f"{road}: {name}"].measured["distance"]
            < 0.75 * results[f"{road}: off"].measured["distance"]
        )


@pytest.mark.parametrize("road", ["wet", "dry, then snow"])
def test_drives_catch_what_friction_brakes_are_too_slow_for(road, results):
    """Largest slips of 0.39 and 0.47 with a brake of 50 ms, 0.24 with a drive of 10 ms.

    And a quarter of the energy.
    """
    slow, fast = (results[f"{road}: {name}"].measured for name in ("friction", "drives"))
    assert fast["peak_slip"] < 0.75 * slow["peak_slip"]
    assert fast["distance"] <= slow["distance"]
    assert fast["share"] > 0.25 > 0.0 > slow["share"]


@pytest.mark.parametrize("road", ["wet", "dry, then snow"])
def test_stability_control_changes_nothing_where_the_car_goes_straight(road, results):
    """Within the noise of the yaw rate, which is inside the deadband."""
    straight, stable = (results[f"{road}: {name}"].measured for name in ("drives", "stability"))
    assert stable["distance"] == pytest.approx(straight["distance"], rel=1e-3)


def test_rows(results):
    rows = braking.rows(argparse.Namespace(), results)
    assert [row[:2] for row in rows] == [tuple(name.split(": ")) for name in results]
    assert all(len(row) == len(braking.COLUMNS) for row in rows)
    assert set(braking.metrics(argparse.Namespace(), results)) >= {
        "distance_wet_off",
        "recovered_wet_drives",
    }
