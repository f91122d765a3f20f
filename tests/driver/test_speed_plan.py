"""How fast a driver takes the bends of a path."""

from __future__ import annotations

import math

import numpy as np
import pytest
from driver.preview_drives import from_circle
from hypothesis import given
from hypothesis import strategies as st

import ev_sim
from ev_msgs_py.parameters.declaration import number_tree
from ev_msgs_py.vehicle.car import GRAVITY
from ev_sim.driver.path import Path, PathParameters, path_of
from ev_sim.driver.preview.speed_plan import SpeedPlanParameters, SpeedPlanState, planned_speed, speed_plan

P = SpeedPlanParameters()
FOLLOWS = type("Numbers", (), number_tree(P) | {"follow": 1.0})
GRIP = P.share * P.friction * GRAVITY


def planned(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Distances along a path [m], some twenty on each leg, and the planned speeds there [m/s]."""
    plan, found = speed_plan(P, path), []
    for leg, length in enumerate(path.length):
        for passed in np.linspace(0.0, length, 20, endpoint=False):
            x, y = path.x[leg] + passed * path.along_x[leg], path.y[leg] + passed * path.along_y[leg]
            speed = planned_speed(FOLLOWS, plan, path, SpeedPlanState(), 0.0, x, y, leg, 0.0)
            found.append((path.start[leg] + passed, speed))
    return tuple(np.array(found).T)


@given(
    lengths=st.lists(st.floats(1.0, 100.0), min_size=1, max_size=6),
    curvatures=st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6),
)
def test_no_bend_is_too_fast_and_none_comes_too_suddenly(lengths, curvatures):
    """V^2/R within the grip but for the chords of half a metre, and V V' = a at most, along any arcs."""
    arcs = PathParameters(shape="arcs", length=tuple(lengths), curvature=tuple(curvatures[: len(lengths)]))
    distance, speed = planned(path_of(arcs))
    growth = np.diff(speed**2) / np.diff(distance)
    assert np.abs(growth[speed[1:] < 1e6]).max(initial=0.0) < 2.0 * P.acceleration * (1.0 + 1e-6)
    begin = 0.0
    for length, curvature in zip(arcs.length, arcs.curvature, strict=True):
        inside = (distance > begin + 0.5) & (distance < begin + length - 0.5)
        assert (speed[inside] ** 2 * abs(curvature) <= GRIP * 1.01).all()
        begin += length


def test_a_circle_is_taken_with_the_share_of_friction():
    distance, speed = planned(path_of(PathParameters(shape="arcs", length=(40.0, 60.0), curvature=(0.0, 1 / 30))))
    bend = (distance > 40.0) & (distance < 99.0)
    assert speed[bend] == pytest.approx(math.sqrt(GRIP * 30.0), rel=1e-3)
    before = distance < 39.0
    assert speed[before] ** 2 == pytest.approx(GRIP * 30.0 + 2 * P.acceleration * (40.0 - distance[before]), rel=0.01)


def test_a_corner_between_waypoints_is_rounded_off():
    """A right angle, passed 0.5 m inside of it: R = 0.5/(sqrt(2) - 1) = 1.2 m, which takes 2.3 m/s."""
    _, speed = planned(path_of(PathParameters(x=(0.0, 50.0, 50.0), y=(0.0, 0.0, 50.0))))
    assert speed.min() == pytest.approx(math.sqrt(GRIP * P.cut / (math.sqrt(2.0) - 1.0)), rel=1e-9)


def into_bend(straight: float, **changed):
    """65 km/h on a straight, then R = 30 m, on dry asphalt."""
    values = {
        "plant.initial_x": 0.0,
        "plant.initial_speed": 65 / 3.6,
        "driver.speed_profile.speed": [65 / 3.6],
        "driver.path.shape": "arcs",
        "driver.path.length": [straight, 150.0],
        "driver.path.curvature": [0.0, 1 / 30],
        "driver.plan.follow": True,
    }
    result = ev_sim.run("double_lane_change", set={**values, **changed}, duration=10.0)
    (run,) = result.runs.values()
    return run


def test_a_driver_slows_down_before_a_bend_that_the_car_cannot_take():
    """65 km/h ask for 10.9 m/s^2 on R = 30 m: 4.4 m/s^2 are planned, and the path is kept within 0.2 m."""
