"""Limits of the motor with an inverter that controls its torque."""

from __future__ import annotations

import pytest

from ev_core.vehicle.motor import Motor
from ev_sim.drives.synchronous_motor import limited_torque

LIMITED = Motor(
    peak_torque=300.0,
    nominal_torque=200.0,
    peak_power=60e3,
    maximum_speed=800.0,
    generator_torque=150.0,
    generator_power=20e3,
)


@pytest.mark.parametrize(
    ("wanted", "speed", "heat", "expected"),
    [
        (500.0, 100.0, 0.0, 300.0),  # peak torque
        (250.0, 300.0, 0.0, 200.0),  # peak power
        (500.0, 100.0, 1.2, 200.0),  # hot: nominal torque
        (100.0, 801.0, 0.0, 0.0),  # beyond the maximum speed
        (-500.0, 100.0, 0.0, -150.0),  # generator torque
        (-500.0, 400.0, 0.0, -50.0),  # generator power
        (-500.0, -100.0, 0.0, -300.0),  # driving backwards
        (500.0, -400.0, 0.0, 50.0),  # generating backwards
    ],
)
def test_motor_limits(wanted, speed, heat, expected):
    assert limited_torque(LIMITED, wanted, speed, heat) == pytest.approx(expected)
