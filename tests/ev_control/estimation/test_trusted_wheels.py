"""Wheel speeds that cannot be are left out of the speed of the car; what could be is not."""

from __future__ import annotations

import os
from random import Random

import pytest
from helpers.traction import FRONT, Control, Measured, in_regulator, on
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels

RADIUS, PERIOD = 0.32, 0.005
DRIVE = Wheels.front(800.0, 800.0)


def control(**changed):
    """A law on the car with front drive, which watches its wheel speeds."""
    watched = {"reference.trust.watch": True, **changed}
    return Control("slip_window", on(FRONT), PERIOD, **watched)


def speeds(car: float, **wrong: float) -> Wheels:
    """Wheels that roll [m/s], some of them wrong."""
    return Wheels(*(wrong.get(wheel, car) / RADIUS for wheel in WHEEL_NAMES))


def accelerate(
    law, seconds: float, begin: float = 2.0, a: float = 1.0, wrong=lambda time, car: {}
) -> list[float]:
    """Drive with a steady acceleration [m/s^2].

    The error of the reference speed in each step [m/s].
    """
    errors = []
    for step in range(round(seconds / PERIOD)):
        time = step * PERIOD
        car = begin + a * time
        law.step(Measured(drive=DRIVE, speed=speeds(car, **wrong(time, car)), torque=DRIVE, a_x=a))
        errors.append(law.state()["control.reference.speed"] - car)
    return errors


def lost(law) -> set[str]:
    return {wheel for wheel in WHEEL_NAMES if law.state()[f"control.reference.trust.lost.{wheel}"]}


def from_1_s(**wrong):
    """Wrong from 1 s on: a number [m/s], or what is made of the right one."""
    return lambda time, car: (
        {w: (f(car) if callable(f) else f) for w, f in wrong.items()} if time >= 1.0 else {}
    )


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (from_1_s(rear_left=0.0), {"rear_left"}),
        (from_1_s(rear_left=0.0, rear_right=0.0), {"rear_left", "rear_right"}),
        (from_1_s(rear_left=3.0), {"rear_left"}),
        (from_1_s(rear_right=lambda car: 1.5 * car), {"rear_right"}),
        (from_1_s(front_left=0.0), {"front_left"}),
        (from_1_s(rear_left=0.0, front_left=0.0), {"rear_left", "front_left"}),
    ],
    ids=["dead", "both dead", "stuck", "scaled", "driven dead", "one of each axle"],
)
def test_what_cannot_be_is_found_and_left_out(wrong, named):
    """Free wheels alone give 50 % of the speed with one of them dead.

    Left out, less than 0.2 m/s are missing.
    """
    law = control()
    errors = accelerate(law, 3.0, wrong=wrong)
    assert lost(law) == named
    assert max(map(abs, errors)) < 0.2


def test_a_sensor_that_comes_back_is_believed_after_a_second():
    law = control()
    wrong = from_1_s(rear_left=0.0)
    accelerate(law, 2.0, wrong=wrong)
    assert lost(law) == {"rear_left"}
    accelerate(law, 0.9, begin=4.0)
    assert lost(law) == {"rear_left"}
    accelerate(law, 0.3, begin=4.9)
    assert lost(law) == set()


def drive_noisily(
    law, car: float, noise: float, step: float, seconds: float, seed: int, a: float = 0.0
) -> set[str]:
    """Wheels ever lost of a car straight on [m/s], by sensors with noise and steps [rad/s]."""
    random, found = Random(seed), set()
    for n in range(round(seconds / PERIOD)):
        rolls = (car + a * n * PERIOD) / RADIUS
        shown = [rolls + random.gauss(0.0, noise) for _ in WHEEL_NAMES]
        speed = Wheels(*(round(w / step) * step if step else w for w in shown))
        law.step(Measured(drive=DRIVE, speed=speed, torque=DRIVE, a_x=a + random.gauss(0.0, 0.05)))
        found |= lost(law)
    return found


@settings(max_examples=int(os.environ.get("EV_CASES", "15")))
@given(
    car=st.floats(1.0, 40.0),
    noise=st.floats(0.0, 0.1),
    step=st.sampled_from((0.0, 0.05, 0.2, 0.5)),
    a=st.sampled_from((0.0, 0.3, 2.0)),
    seed=st.integers(0, 2**32),
)
@example(car=80 / 3.6, noise=0.02, step=0.2, a=0.0, seed=0)
def test_sound_sensors_are_never_lost(car, noise, step, a, seed):
    """Noise and steps do not add up within 0.16 m/s, half of what is allowed."""
    assert drive_noisily(control(), car, noise, step, 2.0, seed, a) == set()


def test_free_wheels_at_one_speed_to_the_bit_are_sound_while_others_spin():
    """Ice, and sensors with steps: the car keeps its speed, and the driven wheels gain 10 m/s."""
    law = control()
    for n in range(200):
        spin = 5.0 + 0.05 * n
        law.step(
            Measured(
                drive=DRIVE, speed=speeds(5.0, front_left=spin, front_right=spin), torque=DRIVE
            )
        )
        assert lost(law) == set()


@pytest.mark.parametrize("time", [0.0, 0.5 * PERIOD, PERIOD, 0.1])
def test_a_lost_sensor_is_believed_again_after_its_recovery(time):
    """A sensor is found within `time` and a period, and believed after 1 s and no later."""
    law = control(**{"reference.trust.time": time})
    accelerate(law, 1.0)
    accelerate(
        law, max(time, PERIOD) + 2.0 * PERIOD, begin=3.0, wrong=lambda *_: {"rear_left": 0.0}
    )
    assert lost(law) == {"rear_left"}
    accelerate(law, 0.98, begin=3.0)
    assert lost(law) == {"rear_left"}
    accelerate(law, 0.04, begin=4.0)
    assert lost(law) == set()


def test_a_spinning_wheel_is_no_lost_sensor():
    """It may turn faster than it rolls for as long as it likes: that is what the law is for."""
    law = control()
    accelerate(
        law,
        3.0,
        wrong=from_1_s(front_left=lambda car: 5.0 * car, front_right=lambda car: 3.0 * car),
    )
    assert lost(law) == set()


def test_everything_is_believed_by_default():
    law = control(**{"reference.trust.watch": False})
    errors = accelerate(law, 2.0, wrong=from_1_s(rear_left=0.0))
    assert lost(law) == set()
    assert errors[-1] < -1.9  # half of 4 m/s


def test_the_wrong_expectation_is_given_up_where_no_wheel_fits_it():
    """A step from 8 to 2 m/s, which no car does.

    Every wheel seems wrong, so all are believed again.
    """
    law = control()
    for step in range(100):
        law.step(Measured(drive=DRIVE, speed=speeds(8.0 if step < 50 else 2.0), torque=DRIVE))
    assert lost(law) == set()
    assert law.state()["control.reference.speed"] == pytest.approx(2.0, abs=0.1)


def test_a_driven_wheel_without_a_speed_gets_what_the_other_gets():
    """The right wheel spins and is limited.

    The left one has a dead sensor and could spin as well.
    """
    law = control()
    accelerate(law, 1.0)
    for _ in range(100):
        torques = law.step(
            Measured(drive=DRIVE, speed=speeds(3.0, front_left=0.0, front_right=5.0), torque=DRIVE)
        )
    assert torques.front_left == torques.front_right < 800.0


@pytest.mark.parametrize("name", ["slip_window", "least_squares", "pi_slip"])
def test_the_partner_of_a_lost_motor_mirrors_it_within_its_limit(name):
    law, torques = (
        Control(name, on(FRONT), PERIOD, **{in_regulator(name, "limp.watch"): True}),
        Wheels.all(0.0),
    )
    for _ in range(100):
        given = Wheels.front(0.0, torques.front_right)
        torques = law.step(Measured(drive=DRIVE, speed=speeds(5.0), torque=given))
    assert torques.front_right == 0.0
    assert torques.front_left == 800.0
