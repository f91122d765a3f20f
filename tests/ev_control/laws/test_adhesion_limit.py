"""Traction control by estimated friction times load (dissertation, eq 1.2), by hand."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.traction import CAR, INERTIA, PERIOD, Control, spinning_at

from ev_msgs_py.contract.wheels import FRONT_LEFT

GRAVITY = 9.81  # m/s^2


def front_load(car, a_x: float = 0.0) -> float:
    """Load of a front wheel [N]: eqs 2.28 to 2.31 without lateral acceleration."""
    at_rest = car.mass * GRAVITY * car.centre_of_mass_to_rear_axle / car.wheelbase / 2
    return at_rest - car.mass * car.centre_of_mass_height / car.wheelbase * a_x / 2


def test_without_slip_the_largest_friction_is_believed():
    """0.95 of 1.2 times load times radius, with 1 m/s^2 that takes 248 N from each front wheel."""
    law = Control("adhesion_limit")
    law.step(spinning_at(10.0, 10.0))
    assert law.of_wheel()["friction"] == 1.2
    assert law.limits()[FRONT_LEFT] == pytest.approx(
        0.95 * 1.2 * front_load(CAR, 1.0) * CAR.wheel_radius, rel=1e-12
    )


def test_friction_in_use_of_a_slipping_wheel_is_that_of_the_road():
    """Slip 0.5 at w' = 100.

    mu = (1500 - J w')/(F_z r), and the limit 0.95 of the torque that the road takes.
    """
    law = Control("adhesion_limit", filter_time=0.0)
    law.step(spinning_at(19.5, 10.0))
    torque = law.step(spinning_at(20.0, 10.0)).front_left
    road = 1500.0 - INERTIA * 0.5 / PERIOD
    assert law.of_wheel()["friction"] == pytest.approx(
        road / (front_load(CAR, 1.0) * CAR.wheel_radius), rel=1e-12
    )
    assert torque == pytest.approx(0.95 * road, rel=1e-12)


def test_estimate_rises_while_the_wheel_grips():
    """0.3 1/s from what the slip has shown: 0.03 in 0.1 s."""
    law = Control("adhesion_limit")
    for speed in (19.0, 19.5, 20.0):
        law.step(spinning_at(speed, 10.0))
    shown = law.of_wheel()["friction"]
    for _ in range(20):
        law.step(spinning_at(10.0, 10.0))
    assert law.of_wheel()["friction"] == pytest.approx(shown + 0.03, rel=1e-12)


def test_a_gear_that_loses_power_gets_more_torque():
    lossy = dataclasses.replace(CAR, motor=dataclasses.replace(CAR.motor, gear_efficiency=0.9))
    limits = []
    for car in (CAR, lossy):
        law = Control("adhesion_limit", car)
        law.step(spinning_at(10.0, 10.0))
        limits.append(law.limits()[FRONT_LEFT])
    assert limits[1] == pytest.approx(limits[0] / 0.9, rel=1e-12)


def test_an_axle_without_any_load_gets_no_torque():
    """All of the mass on the rear axle.

    The front wheels carry nothing, so nothing can be divided by their load.
    """
    tail_heavy = dataclasses.replace(CAR, centre_of_mass_to_rear_axle=0.0)
    law = Control("adhesion_limit", tail_heavy)
    assert law.step(spinning_at(10.0, 10.0)) == (0.0, 0.0, 0.0, 0.0)
