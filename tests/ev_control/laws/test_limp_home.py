"""Limp mode: a motor that misses its command is found; its partner then gives the same."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.limping import CAR, Limping, Motors, at_half, dead, dragging, stuck_at

from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

LEFT_OR_RIGHT = pytest.mark.parametrize("side", [0, 1])


def only(side: int, fault):
    return (fault, None) if side == 0 else (None, fault)


def test_sound_motors_get_the_request_to_the_bit():
    assert Limping().drive(200.0, 300.0, 1.0) == Wheels.front(200.0, 300.0)
    assert Limping().drive(-150.0, 100.0, 1.0) == Wheels.front(-150.0, 100.0)


@LEFT_OR_RIGHT
def test_a_dead_motor_takes_its_partner_with_it(side):
    """The partner stops after the allowed 20 ms, six periods of 10 ms with the lag.

    Both motors stay commanded, to show the return.
    """
    limp = Limping(Motors(faults=only(side, dead)))
    assert limp.drive(200.0, 200.0, 0.01) == Wheels.front(200.0, 200.0)
    command = limp.drive(200.0, 200.0, 0.05)
    assert (command[1 - side], command[side]) == (0.0, 200.0)


@LEFT_OR_RIGHT
@pytest.mark.parametrize("asked", [200.0, -200.0])
@pytest.mark.parametrize(
    ("fault", "noise"), [(dragging, 0.0), (lambda _: 1.0, 0.0), (dead, 1.0), (dead, 10.0)]
)
def test_a_dead_motor_that_shows_a_little_torque_is_dead(side, asked, fault, noise):
    """Drag or noise of either sign makes no torque of a dead motor."""
    limp = Limping(Motors(faults=only(side, fault), noise=noise))
    assert abs(limp.drive(asked, asked, 0.1)[1 - side]) <= 4.0 * noise + 1.1
    assert limp.lost()[side] == 1


def test_the_difference_that_was_asked_for_stays_as_far_as_it_fits_the_request():
    """50 N m more on the right are given there, without torque against the left request."""
    assert Limping(Motors(faults=only(0, dead))).drive(200.0, 250.0, 1.0) == Wheels.front(
        200.0, 50.0
    )
    assert Limping(Motors(faults=only(1, dead))).drive(200.0, 250.0, 1.0) == Wheels.front(
        0.0, 250.0
    )


@LEFT_OR_RIGHT
def test_where_drives_steer_the_difference_is_given_whatever_its_sign_is(side):
    """The brakes get no difference, for they would work against it."""
    limp = Limping(Motors(faults=only(side, dead)), keep_difference=True)
    assert limp.drive(200.0, 250.0, 1.0)[1 - side] == (50.0, -50.0)[side]
    braked = limp.step(Wheels.front(200.0, 250.0), Wheels.all(50.0), Wheels.all(100.0))
    assert braked[1 - side] == (50.0, 0.0)[side]


@LEFT_OR_RIGHT
def test_a_weak_motor_is_mirrored(side):
    limp = Limping(Motors(faults=only(side, at_half)))
    assert limp.drive(200.0, 200.0, 1.0)[1 - side] == pytest.approx(100.0, rel=1e-12)


def test_a_stuck_motor_is_mirrored_and_what_it_gives_too_much_is_saved_by_its_partner():
    """Asked for 100 N m in all: 60 and 40, and nothing beside 300; never against the request."""
    assert Limping(Motors(faults=(stuck_at(30.0), None))).drive(100.0, 100.0, 1.0)[
        1
    ] == pytest.approx(30.0)
    assert Limping(Motors(faults=(stuck_at(90.0), None))).drive(50.0, 50.0, 1.0)[
        1
    ] == pytest.approx(10.0)
    assert Limping(Motors(faults=(stuck_at(300.0), None))).drive(50.0, 50.0, 1.0)[1] == 0.0
    assert Limping(Motors(faults=(stuck_at(300.0), None))).drive(-80.0, -80.0, 1.0)[1] == 0.0


@LEFT_OR_RIGHT
def test_a_stuck_motor_is_not_doubled_on_the_brakes(side):
    """A motor stuck at 300 N m, the driver brakes with 400 N m.

    Its partner gives nothing, and may still recuperate.
    """
    limp = Limping(Motors(faults=only(side, stuck_at(300.0))))
    for asked in (0.0, -100.0):
        for _ in range(50):
            command = limp.step(Wheels.front(asked, asked), Wheels.all(50.0), Wheels.all(100.0))
        assert limp.lost()[side] == 1
        assert command[1 - side] <= 0.0


@pytest.mark.parametrize(
    "faults", [(dead, None), (None, dead), (dead, dead), (at_half, at_half), (dead, at_half)]
)
def test_drive_is_back_after_a_fault(faults):
    """Within 0.5 s of torques, and what the lag takes.

    At once what the lost motor gives, so that the car drives.
    """
    limp = Limping(Motors(faults=faults))
    limp.drive(200.0, 200.0, 0.5)
    limp.motors.faults = (None, None)
    assert limp.drive(200.0, 200.0, 0.1) == pytest.approx(Wheels.front(200.0, 200.0), rel=1e-3)
    limp.drive(200.0, 200.0, 0.5)
    assert limp.lost() == [0, 0]
    assert limp.drive(200.0, 200.0, 0.01) == Wheels.front(200.0, 200.0)


def test_a_motor_that_comes_back_is_not_believed_by_torques_about_zero():
    limp = Limping(Motors(faults=(dead, None)))
    limp.drive(200.0, 200.0, 0.5)
    limp.motors.faults = (None, None)
    limp.drive(5.0, 5.0, 2.0)
    assert limp.lost() == [1, 0]


@pytest.mark.parametrize("common", [{"battery": 0.3}, {"most": 60.0}, {"battery": 0.0}], ids=str)
def test_what_limits_both_motors_is_no_loss(common):
    """A weak battery, a low voltage, a cut-off.

    The car gets what there is, and all of it as soon as there is more.
    """
    limp = Limping(Motors(**common))
    assert limp.drive(200.0, 250.0, 2.0) == Wheels.front(200.0, 250.0)


@pytest.mark.parametrize("efficiency", [0.5, 0.7, 0.97])
@pytest.mark.parametrize("asked", [400.0, -200.0])
@pytest.mark.parametrize("speed", [0.0, 20.0, -20.0])
def test_a_gear_with_losses_is_no_loss_of_a_motor(efficiency, asked, speed):
    """Driving and recuperating, forwards and in reverse; a dead motor is one all the same."""
    car = dataclasses.replace(CAR, motor=dataclasses.replace(CAR.motor, gear_efficiency=efficiency))
    assert Limping(Motors(car)).drive(asked, asked, 1.0, speed) == Wheels.front(asked, asked)
    limp = Limping(Motors(car, faults=(dead, None)))
    assert limp.drive(asked, asked, 1.0, speed)[1] == 0.0


@pytest.mark.parametrize("asked", [200.0, -200.0])
def test_a_weak_motor_is_mirrored_at_the_wheel(asked):
    """Gears that take a tenth, either way, are counted."""
    car = dataclasses.replace(CAR, motor=dataclasses.replace(CAR.motor, gear_efficiency=0.9))
    limp = Limping(Motors(car, faults=(at_half, None)))
    limp.drive(asked, asked, 1.0)
    assert limp.lost() == [1, 0]
    assert limp.measured[1] == pytest.approx(limp.measured[0], rel=1e-6)


def test_a_wheel_that_spins_to_the_limits_of_its_motor_is_no_loss():
    """Power leaves, at three times the speed of its partner, a third of the torque.

    At the largest speed nothing.
    """
    car = dataclasses.replace(
        CAR, motor=dataclasses.replace(CAR.motor, peak_power=10e3, maximum_speed=500.0)
    )
    limp, asked = Limping(Motors(car)), Wheels.front(250.0, 250.0)
    for speed in (40.0, 80.0, 120.0, 500.0 / CAR.gear_ratio):
        limp.motors.faults = (dead if speed > 150.0 else None, None)
        for _ in range(100):
            assert limp.step(asked, Wheels(speed, 40.0, 40.0, 40.0)) == asked


@pytest.mark.parametrize("lag", [1e-4, 0.005, 0.05, 0.5])
@pytest.mark.parametrize("period", [0.001, 0.01, 0.05])
def test_a_slow_drive_is_expected_to_be_slow(lag, period):
    """The lag is the car's.

    Full drive to full recuperation and back, at every period of the controller.
    """
    car = dataclasses.replace(CAR, motor=dataclasses.replace(CAR.motor, torque_lag=lag))
    limp = Limping(Motors(car, period))
    for asked in (380.0, -380.0, 380.0, 0.0, -30.0):
        assert limp.drive(asked, asked, 5.0 * max(lag, period)) == Wheels.front(asked, asked)


def test_a_torque_that_cannot_be_measured_counts_as_none():
    """A broken sensor does no more than a dead motor.

    A command that is finite, and never a larger one.
    """
    for broken in (math.nan, math.inf, 1e300):
        limp = Limping()
        for _ in range(50):
            limp.measured = Wheels.front(broken, limp.measured[1])
            command = limp.step(Wheels.front(200.0, 200.0), Wheels.all(50.0))
        assert command == Wheels.front(200.0, 0.0)
        assert limp.step(NO_WHEELS, Wheels.all(50.0)) == NO_WHEELS
