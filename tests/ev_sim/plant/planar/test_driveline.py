"""Differentials and clutches between the motors and the wheels."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plant.planar.car import drive, plant

from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_sim.drives.driveline import wheel_torques
from ev_sim.plant.planar.planar_state import index


def test_open_differential_passes_equal_torque():
    car = Vehicle(driven_wheels=("rear_left", "rear_right"), driveline=Driveline(coupling="open"))
    out = drive(plant(car, road__left=("ice",)), 1.0, Wheels.rear(500.0, 100.0))
    assert (
        out[WheelStates].effort.rear_left
        == out[WheelStates].effort.rear_right
        == pytest.approx(300.0)
    )
    assert out[WheelStates].velocity.rear_left > 5 * out[WheelStates].velocity.rear_right


def test_limited_slip_differential_helps_the_wheel_with_grip():
    """The slower wheel gets the locking torque more; the car pulls away faster than open."""
    torques = np.zeros(4)
    rear = ("rear_left", "rear_right")
    limited = Driveline(coupling="limited_slip", preload=50.0, locking_ratio=0.3, locking_speed=1.0)
    car = namespace(car_numbers(Vehicle(driven_wheels=rear, driveline=limited)))
    wheel_torques(car, (0.0, 0.0, 300.0, 300.0), (0.0, 0.0, 90.0, 5.0), (0.0,) * 4, torques)
    assert torques[3] - torques[2] == pytest.approx(50.0 + 0.3 * 600.0)
    assert torques.sum() == pytest.approx(600.0)
    reached = {}
    for coupling in ("open", "limited_slip"):
        car = Vehicle(driven_wheels=rear, driveline=Driveline(coupling=coupling))
        moved = plant(car, road__left=("ice",))
        drive(moved, 2.0, Wheels.rear(300.0, 300.0))
        reached[coupling] = moved.state[0]
        assert moved.state[index("driveline_loss")] > -1e-6
    assert reached["limited_slip"] > 1.2 * reached["open"]


def test_clutch_shares_follow_with_their_lag():
    """A step of the share is followed by 63.2 % after 0.1 s (Zhileykin)."""
    car = Vehicle(driven_wheels=WHEEL_NAMES, driveline=Driveline(coupling="clutch"))
    moved = plant(car)
    drive(moved, 1.0, Wheels.rear(100.0, 100.0))
    drive(moved, 0.1, Wheels.all(50.0))
    share = moved.state[index("torque_share") :][:4]
    assert share[0] == pytest.approx(0.25 * (1.0 - math.exp(-1.0)), rel=1e-3)
    assert share.sum() == pytest.approx(1.0)


def test_equal_rotors_add_to_the_wheels():
    """Acceleration on a level road: M/r over m + sum(J)/r^2, with the rotors behind their gears."""
    car = Vehicle(rolling_resistance=0.0, drag_coefficient=0.0, motor=Motor(rotor_inertia=0.1))
    moved = plant(car, initial_speed=5.0)
    drive(moved, 0.5, Wheels.front(50.0, 50.0))
    before = moved.state[0]
    drive(moved, 0.5, Wheels.front(50.0, 50.0))
    inertia = 4 * 1.0 + 2 * 0.1 * 2.65**2
    expected = 100.0 / 0.294 / (1400.0 + inertia / 0.294**2)
    assert (moved.state[0] - before) / 0.5 == pytest.approx(expected, rel=2e-3)
