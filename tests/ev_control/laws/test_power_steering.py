"""Power steering of Shchur (2019), alone and on his steering column."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.signal
from helpers.differentials import REAR, SHCHUR, Differential, Motion, on
from helpers.steering_loop import LEVER, PERIOD, RATIO, B, Column, J, K, difference, drive, law

from ev_msgs_py.contract.signals import SteeringColumnState
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError


def test_power_steering_is_equation_4():
    """(2 r_k i/d) (5 M_b - 0.051 alpha - 0.062 alpha') with M_b = 2, alpha = 3, alpha' = -4."""
    request = law("power_steering").step(
        Motion(column=SteeringColumnState(3.0, -4.0, 2.0, 0.0, 0.0))
    )
    assert difference(request) == pytest.approx(
        2 * 0.294 * 16 / 1.462 * (10 - 0.153 + 0.248), rel=1e-14
    )


def test_all_wheel_drive_keeps_the_difference_on_the_front_axle():
    """Hand torque 1 N m.

    Delta M = (2 r_k i/d) gamma = 32.17 N m, half of it to each side of 25 N m per wheel.
    """
    differential = Differential("power_steering", on(SHCHUR, WHEEL_NAMES))
    request = differential.step(
        Motion(torque=100.0, column=SteeringColumnState(0.0, 0.0, 1.0, 0.0, 0.0))
    )
    half = 16 * 5 / LEVER / 2
    assert request.drive == pytest.approx((25 - half, 25 + half, 25, 25), rel=1e-14)


@pytest.mark.parametrize("driven", [REAR, ("front_left",), ()])
def test_a_car_without_two_front_drives_is_refused(driven):
    drives = ", ".join(driven) or "none"
    line = f"power_steering needs front_left and front_right among the driven wheels, vehicle audi_a2 drives {drives}$"
    with pytest.raises(ParameterError, match=line):
        Differential("power_steering", on(SHCHUR, driven))


def test_closed_loop_reaches_the_values_that_follow_from_the_paper():
    """Fig 1a, curve 2, M_b = 1 N m: 1.2299 rad, overshoot 1.7 %, 5 % settling 0.63 s.

    Bands: steady 0.5 %, overshoot 1 point, settling 5 %. Fig 1b: the difference begins with
    (2 r_k i/d) gamma = 32.2 N m and ends with (2 r_k/d)(gamma i - i^2 k_ck 1.2299) = 25.7 N m.
    """
    angle, torque = drive(Column("powered"), law("power_steering"), hand_torque=1.0, duration=10.0)
    assert angle[-1] == pytest.approx(1.2299, rel=0.005)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(1.7, abs=1.0)
    outside = np.flatnonzero(abs(angle / angle[-1] - 1) > 0.05)
    assert (outside[-1] + 1) * PERIOD == pytest.approx(0.63, rel=0.05)
    assert torque.max() == pytest.approx(16 * 5 / LEVER, rel=0.005)
    assert torque[-1] == pytest.approx((80 - 256 * 0.051 * 1.2299) / LEVER, rel=0.005)


def test_closed_loop_follows_the_exact_step_response():
    """Eq 7 by scipy.

    The assistance is late by 1 ms (the sensor) and half a period (the hold): with the fastest
    motion of 3.6 rad/s that is 5.4 mrad at most.
    """
    angle, _ = drive(Column("powered"), law("power_steering"), hand_torque=1.0, duration=3.0)
    time = np.arange(angle.size) * PERIOD
    stiffness, damping = K + RATIO**2 * 0.051, B + RATIO**2 * 0.062
    _, exact = scipy.signal.step(
        scipy.signal.TransferFunction([6 * RATIO], [J, damping, stiffness]), T=time
    )
    fastest = np.diff(exact).max() / PERIOD
    assert fastest < 3.6
    assert abs(angle - exact).max() < fastest * 1.5 * PERIOD


def test_holding_30_degrees_assisted():
    """0.426 N m at the steering wheel with 10.95 N m between the wheels.

    The digits printed, 0.5 %.
    """
    angle, torque = drive(
        Column("powered"), law("power_steering"), hand_torque=0.426, duration=10.0
    )
    assert math.degrees(angle[-1]) == pytest.approx(30.0, rel=0.005)
    assert torque[-1] == pytest.approx(10.95, rel=0.005)


def test_virtual_spring_and_damper_bring_the_wheels_back():
    """Let go at 0.5 rad, eq 5 is damped with 0.79 of critical.

    It passes zero by e^(-pi 0.79/0.61) = 1.7 %.
    """
    column = Column("powered")
    column.put(road_wheel_angle=0.5)
    angle, _ = drive(column, law("power_steering"), hand_torque=0.0, duration=5.0)
    assert angle.min() > -0.5 * 0.018
    # e^(-4.17 t) of the envelope leaves 1e-9 after 5 s.
    assert abs(angle[-1]) < 1e-8
