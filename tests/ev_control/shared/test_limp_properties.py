"""Properties of limp modes whatever happens.

Never more than asked, nothing from a sound car, back after a fault.

`EV_CASES=100000 python -m pytest tests/ev_control/shared/test_limp_properties.py` is the long form.
"""

from __future__ import annotations

import dataclasses
import os

import pytest
from helpers.limping import CAR, PERIOD, Limping, Motors, at_half, dead, dragging, stuck_at
from helpers.traction import (
    METHODS,
    Control,
    Measured,
    cars,
    driven,
    in_regulator,
    sequences,
    swapped,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

CASES = int(os.environ.get("EV_CASES", "0"))
several = settings(max_examples=CASES or 30)
SOUND = (None, None)

torques = st.floats(-600.0, 600.0) | st.sampled_from((0.0, 400.0))
requests = st.lists(  # left, right [N m], how many periods
    st.tuples(torques, torques, st.integers(1, 40)) | torques.map(lambda asked: (asked, asked, 40)),
    min_size=1,
    max_size=6,
)
speeds = st.floats(-120.0, 120.0) | st.sampled_from((0.0, 50.0))
bends = st.floats(0.8, 1.25)  # what the right wheel turns faster
periods = st.sampled_from((0.001, 0.005, PERIOD, 0.03))
broken = st.sampled_from(
    [
        (dead, None),
        (None, dead),
        (at_half, None),
        (None, stuck_at(250.0)),
        (dead, dead),
        (dead, at_half),
        (dragging, None),
    ]
)


def car_with(efficiency: float, lag: float):
    """The car with such a gear and drive."""
    return dataclasses.replace(
        CAR, motor=dataclasses.replace(CAR.motor, gear_efficiency=efficiency, torque_lag=lag)
    )


vehicles = st.builds(car_with, st.floats(0.5, 1.0), st.floats(1e-4, 0.2))


def commanded(limp: Limping, parts, speed: float, bend: float = 1.0):
    """Requests and commands of the drives, period by period."""
    for left, right, count in parts:
        asked = Wheels.front(left, right)
        for _ in range(count):
            yield asked, limp.step(asked, Wheels(speed, bend * speed, speed, speed))


@several
@given(sequence=sequences, keeps=st.booleans())
def test_never_more_than_asked_and_never_of_the_other_sign(sequence, keeps):
    """Whatever is measured.

    Where drives steer, no more than request or difference, and as ever on the brakes.
    """
    limp = Limping(keep_difference=keeps)
    for m in sequence:
        limp.measured = m.torque
        command = limp.step(m.drive, m.speed, m.brake)
        for i, (asked, torque) in enumerate(zip(m.drive, command, strict=True)):
            difference = asked - m.drive[(1, 0, 3, 2)[i]]
            free = keeps and m.brake == NO_WHEELS
            assert (
                min(asked, 0.0, difference if free else 0.0)
                <= torque
                <= max(asked, 0.0, difference if free else 0.0)
            )


@several
@given(sequence=sequences, car=cars, keeps=st.booleans(), name=st.sampled_from(METHODS))
def test_a_limp_mode_never_gives_more_than_traction_control_alone(sequence, car, keeps, name):
    """Limits by the sizes, with any motor.

    What is cut from a wheel is never given to it, nor to the other one.
    """
    watch = {
        in_regulator(name, "limp.watch"): True,
        in_regulator(name, "limp.plausibility.keep_difference"): keeps,
    }
    alone, limp = Control(name, car), Control(name, car, **watch)
    for m in sequence:
        limited = alone.step(m)
        for i, (least, torque) in enumerate(zip(limited, limp.step(m), strict=True)):
            j = (1, 0, 3, 2)[i]
            difference = abs(m.drive[i] - m.drive[j]) if keeps and least == m.drive[i] else 0.0
            assert abs(torque) <= max(abs(least), difference)
            assert keeps or torque * least >= 0.0


@several
@given(sequence=sequences, keeps=st.booleans())
def test_left_and_right_mirror_to_the_bit(sequence, keeps):
    limp, mirror = Limping(keep_difference=keeps), Limping(keep_difference=keeps)
    for m in sequence:
        limp.measured, mirror.measured = m.torque, swapped(m.torque)
        assert mirror.step(swapped(m.drive), swapped(m.speed), swapped(m.brake)) == swapped(
            limp.step(m.drive, m.speed, m.brake)
        )


@several
@given(
    parts=requests,
    speed=speeds,
    bend=bends,
    vehicle=vehicles,
    period=periods,
    battery=st.floats(0.0, 1.0) | st.just(1.0),
    most=st.floats(398.0, 700.0),
    noise=st.floats(0.0, 8.0),
    seed=st.integers(0, 2**32),
)
# gear losses at the limit
@example([(277.0, 554.0, 26)], 0.0, 1.0, car_with(0.5, 0.004), 0.03, 1.0, 398.0, 0.0, 0)
@example(
    [(12.0, 400.0, 17), (343.0, 77.0, 30)],
    71.6,
    0.976,
    car_with(0.846, 0.0427),
    0.03,
    0.21,
    442.0,
    7.0,
    1692712403,
)
@example(
    [(-189.0, -189.0, 40)] * 20,
    3.8,
    1.246,
    car_with(0.6, 0.0294),
    0.03,
    0.005,
    685.0,
    8.0,
    3956271888,
)
def test_a_sound_car_gets_what_was_asked_to_the_bit(
    parts, speed, bend, vehicle, period, battery, most, noise, seed
):
    """Any share of the battery, hot or cold motors, gears, lags, periods, bends, noisy sensors."""
    limp = Limping(Motors(vehicle, period, most, battery, noise=noise, seed=seed))
    for asked, command in commanded(limp, parts, speed, bend):
        assert command == asked


@several
@given(
    asked=torques,
    speed=speeds,
    vehicle=vehicles,
    period=periods,
    most=st.floats(0.0, 700.0),
    limits=st.lists(st.floats(0.0, 1.0), max_size=4),
)
def test_limits_that_no_controller_knows_are_no_loss_where_both_meet_them(
    asked, speed, vehicle, period, most, limits
):
    """Equal commands pass unchanged: battery cut off, derated and back, at any voltage."""
    limp = Limping(Motors(vehicle, period, most))
    for limp.motors.battery in (1.0, *limits, 1.0):
        for request, command in commanded(limp, [(asked, asked, 20)], speed):
            assert command == request


@several
@given(parts=requests, speed=speeds, vehicle=vehicles, fault=broken, asked=st.floats(80.0, 390.0))
def test_all_drive_is_back_after_a_fault(parts, speed, vehicle, fault, asked):
    """`recovery`, 0.5 s, of torques that are not about zero, and ten time constants."""
    speed = max(min(speed, 80.0), -80.0)
    limp = Limping(Motors(vehicle, faults=fault))
    list(commanded(limp, parts, speed))
    limp.motors.faults = SOUND
    back = round((0.5 + 10.0 * vehicle.motor.torque_lag) / PERIOD) + 10
    *_, (_, command) = commanded(limp, [(asked, asked, back)], speed)
    assert limp.lost() == [0, 0]
    assert command == Wheels.front(asked, asked)


@several
@given(
    asked=st.floats(60.0, 390.0),
    more=st.floats(0.8, 1.25),
    fault=st.sampled_from([dead, dragging, at_half]),
    speed=speeds,
)
@pytest.mark.parametrize("side", [0, 1])
def test_a_lost_motor_does_not_turn_the_car(asked, more, fault, speed, side):
    """0.4 s after it.

    What acts on left and right differs by what was asked, and by what is allowed and half as much.

    The allowance is 20 N m and a fifth; of a deviation half as large again as that 0.02 s/0.5 and the
    lag are enough. Speeds are those at which 0.7 of the power that a motor takes or gives is enough
    for it: beyond them less may be a limit.
    """
    limp = Limping(Motors(faults=(fault, None) if side == 0 else (None, fault)))
    requests = (asked, more * asked) if side == 0 else (more * asked, asked)
    fastest = 0.7 * min(CAR.motor.generator_power, CAR.motor.peak_power) / max(requests)
    list(commanded(limp, [(*requests, 40)], max(min(speed, fastest), -fastest)))
    left, right, *_ = limp.measured
    assert abs(left - right) <= abs(more - 1.0) * asked + 1.5 * (20.0 + 0.2 * max(requests))


@pytest.mark.parametrize("noise", [8.0, 12.0])
def test_noise_about_zero_torque_does_not_add_up(noise):
    """A sensor with half the allowed deviation of 20 N m as its standard deviation.

    None in 50 s without torque.
    """
    limp = Limping(Motors(noise=noise))
    for _ in range(5000):
        limp.step(NO_WHEELS, Wheels.all(50.0))
        assert limp.lost() == [0, 0]


def test_random_measurements_are_what_the_strategy_says():
    """The sequences above lose motors, or they would say nothing."""
    lost = 0

    @settings(max_examples=20, database=None, derandomize=True)
    @given(asked=st.lists(driven, min_size=5, max_size=20))
    def drive(asked: list[Measured]) -> None:
        nonlocal lost
        limp = Limping()
        for m in asked:
            limp.measured = m.torque
            limp.step(m.drive, m.speed)
        lost += sum(limp.lost())

    drive()
    assert lost > 0
