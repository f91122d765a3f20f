"""Roads: segments, patterns, random surfaces."""

from __future__ import annotations

import re

import numpy as np
import pytest

from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import (
    SURFACES,
    RoadParameters,
    Surface,
    interpolate,
    left_and_right,
    segment_at,
)
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario


def test_random_sides_are_independent_repeatable_and_have_the_given_shares():
    road = RoadParameters(pattern="random", random_distance=1e5)
    left, right = left_and_right(road)
    assert (left, right) == left_and_right(road)
    assert left != right
    for side in (left, right):
        lengths = np.diff(side.start)
        assert lengths.min() >= 5.0 and lengths.max() <= 50.0
        wet = lengths[np.array(side.surface[:-1]) == "wet_asphalt_1"].sum() / lengths.sum()
        # about 3600 draws: two standard deviations are 0.02
        assert wet == pytest.approx(0.4, abs=0.03)


def test_jump_and_checkerboard():
    jump, _ = left_and_right(
        RoadParameters(pattern="segments", left=("dry_asphalt", "ice"), length=(30.0,))
    )
    assert [jump.at(s) for s in (-5.0, 29.9, 30.0, 1e6)] == [
        "dry_asphalt",
        "dry_asphalt",
        "ice",
        "ice",
    ]
    left, right = left_and_right(
        RoadParameters(pattern="checkerboard", left=("ice",), length=(10.0,))
    )
    assert [left.at(s) for s in (5.0, 15.0, 25.0)] == ["ice", "dry_asphalt", "ice"]
    assert [right.at(s) for s in (5.0, 15.0, 25.0)] == ["dry_asphalt", "ice", "dry_asphalt"]


def test_look_up_goes_both_ways():
    start = np.array([-1e9, 10.0, 20.0])
    assert [segment_at(start, s, n) for s, n in ((5.0, 2), (10.0, 0), (25.0, 0), (15.0, 2))] == [
        0,
        1,
        2,
        1,
    ]


def test_slope_is_linear_between_points_and_constant_outside():
    at, grade = np.array([10.0, 20.0]), np.array([0.0, 0.1])
    values = [interpolate(at, grade, s, 0)[0] for s in (0.0, 15.0, 30.0)]
    assert values == pytest.approx([0.0, 0.05, 0.1])


SNOW = SURFACES["packed_snow_1"]
OWN = {
    "own": ("gravel", "oil"),
    "own_c1": (SNOW.c1, 0.1),
    "own_c2": (SNOW.c2, 30.0),
    "own_c3": (SNOW.c3, 0.01),
    "own_rolling_resistance": (SNOW.rolling_resistance, 0.0),
}


def test_a_surface_of_ones_own_drives_as_one_of_the_table_with_its_numbers():
    def driven(*road: tuple) -> np.ndarray:
        pedals = {"time": (0.0, 0.1), "drive_torque": (0.0, 2000.0), "brake_torque": (0.0, 0.0)}
        values = [("driver", f"pedals.{name}", value) for name, value in pedals.items()]
        values += [("plant", f"road.{name}", value) for name, value in road]
        run = load_scenario("launch_split_mu", Overrides((), values, 0.5)).runs[0]
        return run_offline(run.configurations, run.duration).channels

    table, own = driven(("left", ("packed_snow_1",))), driven(("left", ("gravel",)), *OWN.items())
    assert all(np.array_equal(own[name], table[name]) for name in table)
    slippery = driven(("left", ("oil",)), *OWN.items())
    friction = slippery["tire_forces.friction_coefficient.front_left"]
    assert friction == pytest.approx(Surface(0.1, 30.0, 0.01).peak_friction)
    assert 0.0 < slippery["twist.longitudinal"][-1] < table["twist.longitudinal"][-1]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"left": ("gravl",)}, "left: unknown surface 'gravl'; did you mean gravel"),
        (
            {"own": ("ice", "oil")},
            "own 'ice' is refused: there is such a surface, expected another name",
        ),
        ({"own": ("gravel", "gravel")}, "own 'gravel' is refused"),
        (
            {"own_c2": (10.0,)},
            "own_c1, own_c2, own_c3 and own_rolling_resistance need one number for each of own",
        ),
        ({"own_c3": (0.2, 0.1)}, "own 'oil' has no friction at a slip of 1, expected a smaller c3"),
    ],
)
def test_surfaces_of_ones_own_that_make_no_sense_are_refused(values, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        RoadParameters(**{**OWN, **values})


def test_roads_that_make_no_sense_are_refused():
    with pytest.raises(ParameterError, match="slope_distance must rise"):
        RoadParameters(slope_distance=(1.0, 0.0), grade=(0.0, 0.0), side_slope=(0.0, 0.0))
    with pytest.raises(ParameterError, match="random_shortest"):
        RoadParameters(random_shortest=60.0)
