"""Friction learnt under slipping wheels."""

from __future__ import annotations

import pytest
from helpers.differentials import DISSERTATION, FRONT_LOAD, Motion

from ev_control.estimation.friction_estimate import (
    FrictionEstimateParameters,
    estimated_friction,
    unknown_road,
)
from ev_control.estimation.plausible import Sensors
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.wheels import Wheels

CAR = namespace(car_numbers(DISSERTATION))
PERIOD = 0.005


class Estimate:
    """A friction estimate on the dissertation's car with rolling rear wheels."""

    def __init__(self, **changed: float) -> None:
        parameters = FrictionEstimateParameters(**changed)
        self.p = namespace(number_tree(parameters))
        self.state = unknown_road(parameters)

    def step(self, torque: float, speeds: Wheels, friction: float) -> Wheels:
        """Both front wheels with the torque that a road of this friction takes."""
        effort = friction * FRONT_LOAD * 0.32
        motion = Motion(torque=torque, speeds=speeds, efforts=Wheels.front(effort, effort))
        _, _, column, wheels, imu, _, _ = motion.signals().values()
        return estimated_friction(
            self.p, CAR, self.state, PERIOD, torque, Sensors(column, wheels, imu)
        )


SLIPPING = Wheels(30.0, 20.0, 20.0, 20.0)
ROLLING = Wheels.all(20.0)


def test_a_slipping_wheel_shows_the_road():
    """It is mu = M/(F_z r) at constant speed, behind the filter.

    T/(T + tau) = 0.2 of it at once, all of it settled.
    """
    estimate = Estimate()
    assert estimate.step(1000.0, SLIPPING, 0.4).front_left == pytest.approx(0.08, rel=1e-12)
    for _ in range(200):
        found = estimate.step(1000.0, SLIPPING, 0.4)
    assert found.front_left == pytest.approx(0.4, rel=1e-12)
    assert found.front_right == 1.2  # it grips: no more than the largest friction


def test_reverse_counts_backwards():
    """The same with all signs turned."""
    estimate = Estimate()
    for _ in range(200):
        found = estimate.step(-1000.0, Wheels(*(-speed for speed in SLIPPING)), -0.4)
    assert found.front_left == pytest.approx(0.4, rel=1e-12)


def test_belief_rises_on_a_wheel_that_grips_again():
    """0.3/s from the 0.08 of one slipping step, for a second."""
    estimate = Estimate()
    estimate.step(1000.0, SLIPPING, 0.4)
    for _ in range(200):
        found = estimate.step(1000.0, ROLLING, 0.0)
    assert found.front_left == pytest.approx(0.08 + 0.3, rel=1e-9)


def test_nothing_is_learnt_without_a_torque():
    estimate = Estimate()
    before = list(estimate.state.friction)
    assert estimate.step(0.0, SLIPPING, 0.4) == tuple(before)
    assert estimate.state.used == [0.0] * 4


def test_speeding_up_takes_torque_that_the_road_does_not_carry():
    """J w' = 2.753 kg m^2 x 20 rad/s^2 = 55 N m more on the left wheel, without filter."""
    estimate = Estimate(filter_time=0.0)
    estimate.step(1000.0, SLIPPING, 0.4)
    found = estimate.step(1000.0, SLIPPING._replace(front_left=30.1), 0.4)
    inertia = CAR.driven_wheel_inertia[0]
    assert (0.4 - found.front_left) * FRONT_LOAD * 0.32 == pytest.approx(inertia * 20.0, rel=1e-9)


def test_wheels_without_a_motor_keep_the_first_belief():
    estimate = Estimate()
    found = estimate.step(1000.0, Wheels(20.0, 20.0, 90.0, 20.0), 0.4)
    assert (found.rear_left, found.rear_right) == (1.2, 1.2)


def test_an_absurd_measurement_changes_nothing():
    """A wheel at 1e200 rad/s overflows in the slip.

    Without a guard NaN would stay in the filter for ever.
    """
    estimate = Estimate()
    for _ in range(200):
        before = estimate.step(1000.0, SLIPPING, 0.4)
    assert estimate.step(1000.0, Wheels(1e200, -1e200, 1e308, 20.0), 0.4) == before
    assert estimate.step(1000.0, SLIPPING, 1e300) == before
    assert estimate.step(1000.0, SLIPPING, 0.4) == before
