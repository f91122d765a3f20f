"""Speeds at which a driver takes the bends of a path."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import GRAVITY
from ev_sim.driver.path import (
    OnLeg,
    Path,
    PathParameters,
    SpeedPlanParameters,
    SpeedPlanState,
    path_of,
    planned_speed,
    speed_plan,
)
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario

P = SpeedPlanParameters()
NUMBERS: Any = SimpleNamespace(**number_tree(P))
GRIP = P.share * P.friction * GRAVITY


def planned(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Distances along a path [m], five on each leg, and the planned speeds there [m/s]."""
    plan, found = speed_plan(P, path), []
    for leg, length in enumerate(path.length):
        for passed in np.linspace(0.0, length, 5, endpoint=False):
            x, y = (
                path.x[leg] + passed * path.along_x[leg],
                path.y[leg] + passed * path.along_y[leg],
            )
            speed = planned_speed(NUMBERS, plan, path, SpeedPlanState(), OnLeg(leg, x, y, 0.0, 0.0))
            found.append((path.start[leg] + passed, speed))
    return tuple(np.array(found).T)


@settings(max_examples=20)
@example(lengths=[1.0], curvatures=[1.9e-10, 0.0, 0.0, 0.0])
@given(
    lengths=st.lists(st.floats(1.0, 20.0), min_size=1, max_size=4),
    curvatures=st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4),
)
def test_no_bend_is_too_fast_and_none_comes_too_suddenly(lengths, curvatures):
    """V^2/R within the grip but for chords of half a metre, V V' = a at most, on any arcs."""
    arcs = PathParameters(
        shape="arcs", length=tuple(lengths), curvature=tuple(curvatures[: len(lengths)])
    )
    distance, speed = planned(path_of(arcs))
    growth = np.abs(np.diff(speed**2) / np.diff(distance))
    # V^2 and the distance are rounded: along a nearly straight arc V^2 is 1e10, and its last bits
    # are worth 1e-5 m/s^2.
    rounding = (
        8.0 * np.finfo(float).eps * (speed[1:] ** 2 + growth * distance[1:]) / np.diff(distance)
    )
    allowed = 2.0 * P.acceleration * (1.0 + 1e-6) + rounding
    assert (growth < allowed)[speed[1:] < 1e6].all()
    begin = 0.0
    for length, curvature in zip(arcs.length, arcs.curvature, strict=True):
        inside = (distance > begin + 0.5) & (distance < begin + length - 0.5)
        assert (speed[inside] ** 2 * abs(curvature) <= GRIP * 1.01).all()
        begin += length


def test_a_circle_is_taken_with_the_share_of_friction():
    distance, speed = planned(
        path_of(PathParameters(shape="arcs", length=(40.0, 60.0), curvature=(0.0, 1 / 30)))
    )
    bend = (distance > 40.5) & (distance < 99.0)
    assert speed[bend] == pytest.approx(math.sqrt(GRIP * 30.0), rel=1e-3)
    before = distance < 39.0
    assert speed[before] ** 2 == pytest.approx(
        GRIP * 30.0 + 2 * P.acceleration * (40.0 - distance[before]), rel=0.01
    )


def test_a_corner_between_waypoints_is_rounded_off():
    """A right angle, passed 0.5 m inside of it.

    R = 0.5/(sqrt(2) - 1) = 1.2 m, which takes 2.3 m/s.
    """
    _, speed = planned(path_of(PathParameters(x=(0.0, 50.0, 50.0), y=(0.0, 0.0, 50.0))))
    assert speed.min() == pytest.approx(math.sqrt(GRIP * P.cut / (math.sqrt(2.0) - 1.0)), rel=1e-9)


def into_bend(straight: float, follows: bool = True) -> tuple[float, float, list[str]]:
    """65 km/h, a straight [m], then R = 30 m, dry.

    Path error of 12 s [m], lowest speed [m/s], the driver's notes.
    """
    values = {
        ("plant", "initial_x"): -straight,
        ("plant", "initial_speed"): 65 / 3.6,
        ("driver", "speed_profile.speed"): [65 / 3.6],
        ("driver", "path.shape"): "arcs",
        ("driver", "path.start_x"): -straight,
        ("driver", "path.length"): [straight, 500.0],
        ("driver", "path.curvature"): [0.0, 1 / 30],
        ("driver", "plan.follow"): follows,
    }
    changed = Overrides(values=[(*name, value) for name, value in values.items()])
    run, notes = load_scenario("double_lane_change", changed).runs[0], []
    recording = run_offline(
        run.configurations, 12.0, note=lambda role, text: notes.append((role, text))
    )
    x, y = recording.channels["pose.x"], recording.channels["pose.y"]
    error = np.where((x < 0.0) & (y < 30.0), y, 30.0 - np.hypot(x, y - 30.0))
    lowest = float(recording.channels["twist.longitudinal"].min())
    return float(np.abs(error).max()), lowest, [text for role, text in notes if role == "driver"]


def test_a_driver_slows_down_before_a_bend_that_the_car_cannot_take():
    """65 km/h ask for 10.9 m/s^2 on R = 30 m.

    0.45 g are planned, and the path is kept within 0.2 m.
    """
    error, lowest, notes = into_bend(60.0)
    assert error < 0.2
    assert lowest == pytest.approx(math.sqrt(GRIP * 30.0), rel=0.05)
    assert notes == []


def test_a_plan_that_comes_too_late_has_a_note():
    """A note names the time from which on the plan is missed.

    10 m before the bend it allows 14 m/s.
    """
    _, _, notes = into_bend(10.0)
    assert notes[0].startswith(
        "the car was too fast for its speed plan from 0.00 s on, by more than 2 m/s"
    )


def test_a_driver_with_a_given_speed_does_not_slow_down():
    error, lowest, notes = into_bend(60.0, follows=False)
    assert lowest > 14.0 and error > 3.5
    assert [note.startswith("the car left the road") for note in notes] == [True]
