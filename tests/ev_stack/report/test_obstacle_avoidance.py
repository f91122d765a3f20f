"""The course of ISO 3888-2, and the scenario that drives it."""

from __future__ import annotations

import numpy as np
import pytest

import ev_stack
from ev_core.vehicle.description import Vehicle
from ev_stack.scenarios.scenario import load_scenario

COURSE = load_scenario("obstacle_avoidance").parameters.course


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("track", "third"), [(1.462, 3.0), (2.0, 1.3 * 2.21 + 0.25)])
def test_the_course_is_that_of_the_standard(side, track, third):
    """Lanes of 12, 11, 12 m, 13.5 and 12.5 m apart, 1.1 w + 0.25, w + 1, 1.3 w + 0.25 wide."""
    car = Vehicle(front_track=track, rear_track=track)
    first, second, last = COURSE.lanes(car, side)
    ends = [(lane.begin, lane.end) for lane in (first, second, last)]
    assert ends == [(0.0, 12.0), (25.5, 36.5), (49.0, 61.0)]
    width = COURSE.body_width(car)
    assert (first.width, second.width) == pytest.approx((1.1 * width + 0.25, width + 1.0))
    assert last.width == pytest.approx(third)
    near_edges = abs(second.middle) - second.width / 2 - first.width / 2
    assert near_edges == pytest.approx(1.0)  # the offset of the standard
    assert np.sign(second.middle) == side and first.middle == last.middle == 0.0


def test_the_car_avoids_the_obstacle_with_its_drives_released():
    """All cones stay at 50 km/h; rolling, air and bends take 5 to 15 % of the speed on 61 m."""
    run = ev_stack.run("obstacle_avoidance")
    assert run.metrics["cones_hit"].value == 0
    assert run.metrics["course_passed"].value == 1
    assert 0.85 < run.metrics["exit_speed"].value / run.metrics["entry_speed"].value < 0.95
    released = np.arange(len(run.signals["pose.x"])) > 220
    assert not run.signals["driver.command.drive_torque"][released].any()
    assert not run.signals["driver.command.brake_torque"][released].any()


def test_a_car_that_drives_straight_on_takes_the_cones_of_the_second_lane():
    """Its body covers 0.66 to 2.34 m.

    The left rows of lanes 1 (1.04 m) and 3 (1.5 m), the right one of 2 (2.04 m).
    """
    straight = {
        "driver.path.x": [-50.0, 200.0],
        "driver.path.y": [1.5, 1.5],
        "plant.initial_y": 1.5,
    }
    driven = ev_stack.run("obstacle_avoidance", set=straight)
    assert driven.metrics["cones_hit"].value == 4 + 4 + 4
    assert driven.metrics["course_passed"].value == 0
