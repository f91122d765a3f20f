"""Steering towards a point of the path that lies ahead."""

from __future__ import annotations

import math

import pytest

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import BodyPose
from ev_sim.driver.followers import PurePursuitParameters, pure_pursuit
from ev_sim.driver.path import PathParameters, path_of

PERIOD = 0.01


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_pure_pursuit_comes_back_to_the_path(speed):
    """A rolling car 1 m and 0.2 rad off a straight path is within 5 cm after 30 m."""
    vehicle = Vehicle()
    path = path_of(PathParameters(x=(-100.0, 100.0), y=(0.0, 0.0)))
    rear_x, rear_y, heading, leg = 0.0, 1.0, 0.2, 0
    for _ in range(1500):
        b = vehicle.centre_of_mass_to_rear_axle
        pose = BodyPose.at(rear_x + b * math.cos(heading), rear_y + b * math.sin(heading), heading)
        angle, leg = pure_pursuit(PurePursuitParameters(), vehicle, path, pose, speed, leg)
        heading += speed / vehicle.wheelbase * math.tan(angle) * PERIOD
        rear_x += speed * math.cos(heading) * PERIOD
        rear_y += speed * math.sin(heading) * PERIOD
    assert abs(rear_y) < 0.05
    assert abs(heading) < 0.02


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_circle_through_the_point_ahead(side):
    """1 m beside the path, 4 m ahead at rest.

    The rear axle is to roll on y = 1, x = 4, 2 L y/(x^2 + y^2) = 2 L/17.
    """
    vehicle, path = Vehicle(), path_of(PathParameters())
    pose = BodyPose.at(vehicle.centre_of_mass_to_rear_axle, -side, 0.0)
    angle, leg = pure_pursuit(PurePursuitParameters(), vehicle, path, pose, 0.0, 0)
    assert (math.tan(angle), leg) == (
        pytest.approx(side * 2 * vehicle.wheelbase / 17.0, rel=1e-12),
        0,
    )


def test_angle_keeps_its_limit():
    """Far beside the path the circle would be narrower than the car can turn."""
    vehicle, path = Vehicle(), path_of(PathParameters())
    for side in (1.0, -1.0):
        pose = BodyPose.at(0.0, -3.0 * side, 0.0)
        assert (
            pure_pursuit(PurePursuitParameters(max_angle=0.1), vehicle, path, pose, 0.0, 0)[0]
            == side * 0.1
        )
