"""Traction control by the largest torque that a tyre transmits (dissertation, eq 1.7), by hand."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.launches import launch, slip_of
from helpers.traction import CAR, PERIOD, SPINNING, Control, spinning_at

from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError

# at once, by the accelerations of this instant alone
ANY_GAIN = {"grip_slip": 0.0, "least_gain": 0.0}
ALWAYS = (("asr", "limits", "always"),)


@pytest.mark.parametrize("relaxation", [0.5, 0.9])
def test_transmissible_torque_by_hand(relaxation):
    """M_w = 1500, w' = 100, J = 1.658 + 7.4^2 0.02 = 2.7532.

    r F_d = 1224.68, times 1 + J/(alpha 1085 0.32^2).
    """
    law = Control(
        "maximum_transmissible_torque", filter_time=0.0, relaxation=relaxation, **ANY_GAIN
    )
    for speed in (10.0, 10.5):
        torque = law.step(spinning_at(speed, speed)).front_left
    assert torque == pytest.approx(
        1224.68 * (1 + 2.7532 / (relaxation * 1085.0 * 0.32**2)), rel=1e-12
    )


def test_a_wheel_that_follows_the_car_is_not_limited():
    """1 m/s^2 of the car is 3.125 rad/s^2 of a wheel that rolls.

    Alpha times that, and the margin, is what it may.
    """
    law = Control("maximum_transmissible_torque", filter_time=0.0)
    for n in range(100):
        speed = 10.0 + 3.125 * 0.005 * n
        assert law.step(spinning_at(speed, speed)).front_left == 1500.0


def test_limit_rises_slowly_once_the_wheel_follows():
    """It rises by 1000 N m/s from the last one of eq 1.7."""
    law = Control("maximum_transmissible_torque", filter_time=0.0, **ANY_GAIN)
    for speed in (10.0, 10.5):
        limit = law.step(spinning_at(speed, speed)).front_left
    for n in range(1, 11):
        assert law.step(spinning_at(10.5, 10.5)).front_left == pytest.approx(
            limit + 5.0 * n, rel=1e-12
        )


def test_always_limits_a_steady_spin_too():
    """Yin, Oh and Hori (2009): eq 1.7 at every instant.

    By hand with w' = 0, where r F_d is the torque itself.
    """
    law = Control("maximum_transmissible_torque", filter_time=0.0, limits="always", relaxation=0.9)
    part = dataclasses.replace(SPINNING, torque=Wheels.front(600.0, 600.0))
    for _ in range(100):
        torque = law.step(part).front_left
    assert torque == pytest.approx(600.0 * (1 + 2.7532 / (0.9 * 1085.0 * 0.32**2)), rel=1e-12)
    assert Control("maximum_transmissible_torque").step(part).front_left == 1500.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("rising", [0.0, 0.2, 1.0])
def test_always_lets_a_pressed_pedal_through_while_the_tyre_grips(sign, rising):
    """A torque that is there 10 ms after its request, at the wheel of a car that follows it.

    All of it passes.

    The rate of the request makes up for the filter of 30 ms and for the drive. A car of 1085 kg a
    wheel gains what the road torque, M - J w', gives it; M = 1000 N m at the end of the ramp.
    """
    law, given = Control("maximum_transmissible_torque", limits="always"), [0.0, 0.0]
    speed, mass = 20.0, CAR.mass / 2.0
    for n in range(400):
        wanted = 1000.0 * min(n * PERIOD / rising, 1.0) if rising else 1000.0
        torque = given[-2]
        turning = torque / (2.7532 + mass * 0.32**2)
        speed += turning * PERIOD
        wheels = Wheels.all(sign * speed)
        drive, effort = (
            Wheels.front(sign * wanted, sign * wanted),
            Wheels.front(sign * torque, sign * torque),
        )
        m = dataclasses.replace(
            SPINNING, drive=drive, torque=effort, speed=wheels, a_x=sign * turning * 0.32
        )
        assert law.step(m) == drive, n
        given.append(wanted)


@pytest.mark.parametrize("surface", ["ice", "packed_snow_1"])
def test_always_slips_less_than_while_gaining(surface):
    """Full throttle, with noise.

    On ice 0.59 on the mean instead of 0.81, on snow 0.47 instead of 0.50; as far.
    """
    every, gaining = (
        launch("maximum_transmissible_torque", (surface,), 3000.0, 1.0, 5.0, more=m)
        for m in (ALWAYS, ())
    )
    mean, other = (slip_of(channels)[100:].mean() for channels in (every, gaining))
    assert mean < (0.8 if surface == "ice" else 0.95) * other
    assert slip_of(every).max() < slip_of(gaining).max()
    assert every["pose.x"][-1] > 0.99 * gaining["pose.x"][-1]


def test_always_is_refused_where_a_wheel_has_no_motor_of_its_own():
    """Behind an engine the torque of a wheel is not its command, and comes later.

    It would lose half of it.
    """
    vehicle = {"vehicle.driveline.coupling": "open"}
    configure("asr", {"method": "maximum_transmissible_torque", **vehicle})
    with pytest.raises(ParameterError, match="a motor for each driven wheel for limits always"):
        configure("asr", {"method": "maximum_transmissible_torque", "limits": "always", **vehicle})
