"""Properties of every traction control whatever happens.

It only takes torque away, mirrors, and keeps out of it.
"""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.traction import (
    CAR,
    CONTROLS,
    METHODS,
    PERIOD,
    ROLE,
    SPINNING,
    Control,
    Measured,
    anything,
    cars,
    driven,
    per_wheel,
    sequences,
    spinning_at,
    spun_up,
    swapped,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_core.parameters.record import names, numbers
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

pytestmark = pytest.mark.slow

# samples of a window that says it is empty, and their sums
RING = ("fit.x.", "fit.y.", "fit.sum_", "fit.offset")


def test_all_twelve_are_asked():
    assert len(METHODS) == 12


def check_limited(asked: Wheels, given_: Wheels) -> None:
    for wanted, torque in zip(asked, given_, strict=True):
        assert math.isfinite(torque)
        assert abs(torque) <= abs(wanted)
        assert torque * wanted >= 0.0


@pytest.mark.sampled
@settings(max_examples=25)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_torque_is_only_ever_taken_away(name, sequence, car):
    law = Control(name, car)
    for m in sequence:
        check_limited(m.drive, law.step(m))


@pytest.mark.sampled
@settings(max_examples=25)
@given(sequence=st.lists(anything | driven, min_size=1, max_size=12), car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_any_finite_numbers_give_finite_torques(name, sequence, car):
    """A broken sensor shows anything.

    Nothing that comes after a sensible number again may be harmed.
    """
    law = Control(name, car)
    for m in sequence:
        check_limited(m.drive, law.step(m))
    assert not any(math.isnan(limit) for limit in law.limits())


@pytest.mark.parametrize("name", METHODS)
def test_broken_measurements_leave_the_limits(name):
    """A wheel that spins is limited.

    A step without a number for its speed keeps the limit to the bit.
    """
    law = spun_up(name)
    limit = law.step(SPINNING).front_left
    broken = dataclasses.replace(SPINNING, speed=Wheels(math.nan, 30.0, 10.0, 10.0))
    assert law.step(broken).front_left == limit


@pytest.mark.sampled
@settings(max_examples=25)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_left_and_right_mirror_to_the_bit(name, sequence, car):
    law, mirror = Control(name, car), Control(name, car)
    for m in sequence:
        assert mirror.step(m.mirrored()) == swapped(law.step(m))


@pytest.mark.sampled
@settings(max_examples=25)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_reverse_mirrors_forward_to_the_bit(name, sequence, car):
    """Reverse mirrors forward without slip angles and the load shift by accelerations."""
    law, mirror = Control(name, car), Control(name, car)
    for m in sequence:
        if name == "adhesion_limit":
            m = dataclasses.replace(m, a_x=0.0)
        elif name == "expected_signal":
            m = dataclasses.replace(m, a_x=0.0, a_y=0.0, yaw_rate=0.0, angle=0.0)
        assert mirror.step(m.reversed()) == Wheels(*(-torque for torque in law.step(m)))


@pytest.mark.sampled
@settings(max_examples=25)
@given(sequence=sequences)
@pytest.mark.parametrize("name", METHODS)
def test_braking_passes(name, sequence):
    """The brake, and regeneration, pass at speed in any state of the law."""
    law = Control(name)
    for m in sequence:
        law.step(m)
    braked = dataclasses.replace(
        sequence[-1], speed=Wheels(25.0, 30.0, 20.0, 20.0), brake=Wheels.front(200.0, 200.0)
    )
    assert law.step(braked) == braked.drive
    regenerates = Measured(Wheels.front(-800.0, -800.0), speed=Wheels(5.0, 8.0, 20.0, 20.0))
    assert law.step(regenerates) == regenerates.drive


@pytest.mark.sampled
@settings(max_examples=20)
@given(
    noise=st.lists(per_wheel(-0.06, 0.06), min_size=60, max_size=60),
    torque=st.floats(-1000.0, 1000.0),
    brake=st.sampled_from([0.0, 1000.0]),
)
@pytest.mark.parametrize("name", METHODS)
def test_at_rest_nothing_happens(name, noise, torque, brake):
    """A car that is held by its brakes or its weight.

    0.06 rad/s of noise, twice its usual standard deviation.
    """
    law, drive = Control(name), Wheels.front(torque, torque)
    for speed in noise:
        assert (
            law.step(Measured(drive, brake=Wheels.all(brake), speed=speed, torque=drive)) == drive
        )


@pytest.mark.parametrize("name", CONTROLS)
def test_a_spinning_wheel_loses_torque_and_the_other_one_does_not(name):
    """The left wheel spins up at 100 rad/s^2, the right one rolls.

    After 0.2 s below 90 % left, and all of it right.
    """
    law = Control(name)
    for n in range(40):
        left, right, *_ = law.step(spinning_at(10.0 + 20.0 * n / 39.0, 10.0))
    assert left < 0.9 * 1500.0
    assert right == 1500.0


@pytest.mark.parametrize("name", METHODS)
def test_a_released_pedal_forgets_all_of_the_wheel(name):
    """Every number of a wheel is that of the start again, and the limit infinite.

    First it was another one.
    """
    law = spun_up(name)
    fresh = Control(name).of_wheel()
    assert law.of_wheel() != fresh
    law.step(dataclasses.replace(SPINNING, drive=NO_WHEELS))
    kept = {
        key: value for key, value in law.of_wheel().items() if not any(part in key for part in RING)
    }
    assert kept == {key: fresh[key] for key in kept}
    assert law.limits() == [math.inf] * 4


@pytest.mark.parametrize("name", METHODS)
def test_what_is_left_of_a_forgotten_wheel_does_nothing(name):
    """A law behind a released pedal goes on like a new one with these wheel speeds, to the bit."""
    law, fresh = spun_up(name), Control(name)
    for control in (law, fresh):
        control.step(dataclasses.replace(SPINNING, drive=NO_WHEELS))
    for n in range(60):
        m = spinning_at(10.0 + 0.4 * n, 11.0 + 0.3 * n)
        assert law.step(m) == fresh.step(m)


@pytest.mark.parametrize("name", METHODS)
def test_state_goes_on_in_another_object_to_the_bit(name):
    """All that lasts is the declared record.

    Its numbers, in another object, go on as if nothing had happened.
    """
    law, other = spun_up(name), Control(name)
    other.law.state = law.law.state
    for n in range(60):
        m = spinning_at(30.0 - 0.2 * n, 30.0 + 0.1 * n)
        assert other.step(m) == law.step(m)
        assert other.law.state == law.law.state


@pytest.mark.parametrize("name", METHODS)
def test_every_number_of_the_state_has_a_name(name):
    law = find_method(ROLE, name).law
    made = law(law.parameters(), CAR, PERIOD)
    assert len(names(law.state())) == len(made.state) == len(numbers(law.state()))
    assert len(set(names(law.state()))) == len(made.state)
