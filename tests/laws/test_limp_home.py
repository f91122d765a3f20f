"""Limp mode: a motor that does not give what it is told is found by its torque, and its partner gives the same."""

from __future__ import annotations

import pytest

from ev_msgs_py.contract.signals import WheelStates, WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.lockstep.methods import create, find_method
from ev_msgs_py.parameters.values import build
from ev_msgs_py.vehicle.description import Vehicle

PERIOD = 0.01
CAR = Vehicle(driven_wheels=("front_left", "front_right"))
SPEEDS = Wheels(50.0, 50.0, 50.0, 50.0)


def law(keep_difference=False):
    method = find_method("asr", "limp_home")
    changed = {"plausibility.keep_difference": keep_difference}
    return create(method, build(method.parameters, changed), CAR, PERIOD)


def driven(asked, gives, steps=100, of=None):
    """Commands while `asked` left and right [N m] and motors that give `gives(left, right)` a period later."""
    controller, measured, commands = of or law(), Wheels(0.0, 0.0, 0.0, 0.0), []
    for _ in range(steps):
        request = WheelTorqueRequest(Wheels.front(*asked), NO_WHEELS)
        commands.append(controller.step(request, WheelStates(NO_WHEELS, SPEEDS, measured)).drive)
        measured = Wheels.front(*gives(*commands[-1][:2]))
    return commands


def sound(left, right):
    return left, right


def test_sound_motors_get_the_request_to_the_bit():
    assert set(driven((200.0, 300.0), sound)) == {Wheels.front(200.0, 300.0)}
    assert set(driven((-150.0, 100.0), sound)) == {Wheels.front(-150.0, 100.0)}


@pytest.mark.parametrize("dead", [0, 1])
def test_a_dead_motor_takes_its_partner_with_it(dead):
    """After the allowed 20 ms: at most ten periods, the lag of what is expected included."""
    commands = driven((200.0, 250.0), lambda left, right: (0.0, right) if dead == 0 else (left, 0.0))
    assert commands[0] == Wheels.front(200.0, 250.0)
    assert all(command[1 - dead] == 0.0 for command in commands[10:])
    assert all(command[dead] == (200.0, 250.0)[dead] for command in commands)  # so that it shows if it comes back


def test_a_weak_motor_is_mirrored():
    commands = driven((200.0, 250.0), lambda left, right: (0.5 * left, right))
    assert commands[-1] == Wheels.front(200.0, 100.0)


def test_a_stuck_motor_is_mirrored_up_to_the_request_and_never_against_it():
    assert driven((50.0, 50.0), lambda left, right: (300.0, right))[-1] == Wheels.front(50.0, 50.0)
    assert driven((-80.0, -80.0), lambda left, right: (300.0, right))[-1] == Wheels.front(-80.0, 0.0)


@pytest.mark.parametrize("dead", [0, 1])
def test_the_difference_that_was_asked_for_is_kept(dead):
    """It steers or turns the car: 50 N m more on the right are 50 N m of the motor that is left, of either sign."""
    gives = (lambda left, right: (0.0, right)) if dead == 0 else (lambda left, right: (left, 0.0))
    command = driven((200.0, 250.0), gives, of=law(keep_difference=True))[-1]
    assert command[1 - dead] == (50.0, -50.0)[dead]
    assert command[dead] == (200.0, 250.0)[dead]


def test_a_motor_that_comes_back_is_believed_after_a_while():
    """Within 0.5 s of right torques and what the lag takes, and not by torques about zero."""
    controller = law()
    assert driven((200.0, 200.0), lambda left, right: (0.0, right), of=controller)[-1][1] == 0.0
    assert driven((5.0, 5.0), sound, of=controller)[-1][1] == 5.0  # 5 N m are what the sound motor gives
    assert driven((200.0, 200.0), lambda left, right: (0.0, right), of=controller)[-1][1] == 0.0
    back = driven((200.0, 200.0), sound, of=controller)
    assert back[20][1] == 200.0 == back[-1][1]  # it gives 200 N m at once, and so may its partner


def test_a_motor_at_its_power_limit_is_not_lost():
    """At 50 rad/s and a gear of 1 the peak power allows what it allows: both give less than asked for, as expected."""
    most = CAR.motor.peak_power / (50.0 * CAR.gear_ratio) * CAR.gear_ratio
    ask = 1.5 * most if most < CAR.motor.peak_torque * CAR.gear_ratio else 2.0 * CAR.motor.peak_torque * CAR.gear_ratio
    limit = min(most, CAR.motor.peak_torque * CAR.gear_ratio)
    commands = driven((ask, 0.9 * ask), lambda left, right: (min(left, limit), min(right, limit)))
    assert set(commands) == {Wheels.front(ask, 0.9 * ask)}
