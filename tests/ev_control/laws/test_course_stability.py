"""Power steering and a yaw moment that share the difference of the front drives.

Computed by hand.
"""

from __future__ import annotations

import dataclasses

import pytest
from helpers.differentials import SHCHUR, Differential, Motion, on, sequences
from helpers.steering_loop import LEVER, difference
from hypothesis import given

from ev_msgs_py.contract.signals import SteeringColumnState
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_papers.shchur2019.course import measure
from ev_study.studies.study import Case, drive_case

LAW = "course_stability"
FAST = Wheels.all(20.0 / 0.294)  # 20 m/s
FRONT_LOAD = 1400.0 * 9.81 * 1.08225 / 2.405 / 2  # of each wheel at rest [N]


def made(**changed) -> Differential:
    return Differential(LAW, SHCHUR, **changed)


def moving(r: float = 0.0, hands: float = 0.0, **changed) -> Motion:
    """Straight wheels at 20 m/s on asphalt."""
    column = SteeringColumnState(0.0, 0.0, hands, 0.0, 0.0)
    return dataclasses.replace(Motion(speeds=FAST, r=r, column=column), **changed)


def test_without_an_error_it_is_equation_4():
    """Shchur's eq 4 with M_b = 2, alpha = 3, alpha' = -4, at rest, without a wanted yaw rate."""
    motion = Motion(column=SteeringColumnState(3.0, -4.0, 2.0, 0.0, 0.0))
    assert difference(made().step(motion)) == pytest.approx(
        16 / LEVER * (10 - 0.153 + 0.248), rel=1e-14
    )


def test_a_car_that_yaws_more_than_wanted_is_held_back():
    """M_z = -200 * 0.1 = -20 N m, and nothing of it within what the hands want.

    0.1 N m is 1.2 rad/s on asphalt.
    """
    assert difference(made().step(moving(r=0.1))) == pytest.approx(-20.0 / LEVER, rel=1e-12)
    assisted = 16 * 5 * 0.1 / LEVER
    assert difference(made().step(moving(r=0.1, hands=0.1))) == pytest.approx(assisted, rel=1e-12)


def test_the_wish_is_bounded_by_the_friction():
    """Friction of 0.1 lets the car turn with 0.9 mu g/u = 0.0441 rad/s.

    At 0.1 rad/s the rest is too much.
    """
    motion = moving(r=0.1, hands=0.1, friction=Wheels.all(0.1), load=Wheels.all(3000.0))
    moment = -200.0 * (0.1 - 0.9 * 0.1 * 9.81 / 20.0)
    assert difference(made().step(motion)) == pytest.approx(
        (16 * 5 * 0.1 + moment) / LEVER, rel=1e-12
    )


def test_against_both_adds_what_is_missing():
    """r* = 20 * 0.01/2.405 by the angle: M_z = 200 (r* - 0.02) turns further into the bend."""
    motion = dataclasses.replace(moving(r=0.02).steered(0.01), speeds=FAST)
    spring = -16 * 0.051 * 0.16
    moment = 200.0 * (20.0 * 0.01 / 2.405 - 0.02)
    assert difference(made(wish="angle", against="both").step(motion)) == pytest.approx(
        (moment + spring) / LEVER
    )
    assert difference(made(wish="angle").step(motion)) == pytest.approx(spring / LEVER, rel=1e-12)


def test_the_hands_never_have_to_hold_more_than_is_stated():
    """16 * 3 N m over the lever however far the car is off."""
    law = made(yaw_gain=1e5)
    assert difference(law.step(moving(r=1.0))) == pytest.approx(-48.0 / LEVER, rel=1e-12)


def test_hands_that_hold_the_wheel_leave_a_sixth_of_the_yaw_moment():
    """Eq 5 held at 0: (1 + gamma) i M_b = -M_z, of which the difference gives gamma i M_b.

    M_z/(1 + gamma) is left.
    """
    law = made(wish="angle")
    assert difference(law.step(moving(r=0.1, hands=20.0 / (6 * 16)))) == pytest.approx(
        -20.0 / 6 / LEVER, rel=1e-10
    )


@pytest.mark.parametrize(("first", "asked", "given"), [
    ("steering", 25.0, -5.0), ("yaw", 25.0, -5.0), ("steering", 1e4, -10.0), ("yaw", 1e4, -50.0),
])  # fmt: skip
def test_the_second_gets_its_demand_within_the_room_that_is_left(first, asked, given):
    """Tyres leave +-50 N m of half a difference; steering asks for 20, yaw for -25 N m or more.

    Both have room beside each other. Yaw that asks too much gets the 0.6 of -50 N m that steering
    leaves beside its 20 N m, or comes first and leaves nothing.
    """
    friction = 50.0 / (0.9 * 0.294 * FRONT_LOAD)
    motion = moving(r=1.0, hands=20.0 * 2 * LEVER / (16 * 5), friction=Wheels.all(friction))
    law = made(first=first, wish="angle", yaw_gain=2 * LEVER * asked, largest_hand_torque=1e9)
    assert difference(law.step(motion)) / 2 == pytest.approx(given, rel=1e-9)


def test_the_drive_torque_comes_before_both():
    """The hands get nothing where it takes all that the tyres hold; the sum is the driver's."""
    friction = Wheels.all(0.9 * 50.0 / (0.9 * 0.294 * FRONT_LOAD))
    drive = made().step(moving(hands=1.0, torque=100.0, friction=friction)).drive
    assert drive[:2] == (50.0, 50.0)


def test_motors_bound_the_difference_and_the_sum_stays():
    """Motors of 20 N m give 53 N m behind 2.65; 40 N m to drive leave 13 N m each way."""
    motor = dataclasses.replace(SHCHUR.motor, peak_torque=20.0)
    weak = Differential(LAW, dataclasses.replace(SHCHUR, motor=motor))
    drive = weak.step(moving(hands=5.0, torque=80.0)).drive
    assert drive[:2] == pytest.approx((27.0, 53.0), rel=1e-12)


@pytest.mark.parametrize("brake", [0.0, 800.0])
def test_reverse_and_braking(brake):
    """Backwards a left turn yaws to the right.

    At -20 m/s with 0.1 N m to the left a yaw rate of -0.1 is no error.
    """
    back = {"speeds": Wheels.all(-20.0 / 0.294), "brake": brake}
    assisted = 16 * 5 * 0.1 / LEVER
    request = made().step(moving(r=-0.1, hands=0.1, **back))
    assert difference(request) == pytest.approx(assisted, rel=1e-12)
    assert sum(request.brake) == pytest.approx(brake, rel=1e-12)
    assert difference(made().step(moving(r=0.1, hands=0.1, **back))) == pytest.approx(
        assisted - 20.0 / LEVER, rel=1e-12
    )


def test_on_split_friction_the_worse_side_counts():
    """Ice under the left wheel bounds both the wanted yaw rate and the room."""
    ice = Wheels(0.05, 0.8, 0.05, 0.8)
    both = (
        made().step(moving(r=0.1, hands=0.01, friction=ice)),
        made().step(moving(r=0.1, hands=0.01, friction=Wheels.all(0.05))),
    )
    assert both[0].drive == both[1].drive


def test_an_absurd_measurement_leaves_the_power_steering():
    motion = moving(r=1e9, hands=1.0)
    assert difference(made().step(motion)) == pytest.approx(16 * 5 / LEVER, rel=1e-12)


@given(sequence=sequences)
def test_at_rest_it_is_power_steering_to_the_bit(sequence):
    """Rear wheels that stand: no yaw rate is wanted or corrected.

    Torques within what asphalt and motors leave.
    """
    for motion in sequence:
        calm = dataclasses.replace(
            motion, speeds=NO_WHEELS, torque=0.0, friction=Wheels.all(1e6), r=0.0
        )
        small = SteeringColumnState(*(value / 100.0 for value in motion.column))
        calm = dataclasses.replace(calm, column=small, efforts=NO_WHEELS)
        assert difference(made().step(calm)) == difference(
            Differential("power_steering", SHCHUR).step(calm)
        )


@pytest.mark.parametrize("driven", [WHEEL_NAMES, ("rear_left", "rear_right")])
def test_other_layouts_are_refused(driven):
    with pytest.raises(ParameterError, match=f"{LAW} needs front_left and front_right"):
        Differential(LAW, on(SHCHUR, driven))


@pytest.mark.slow
def test_a_lane_change_on_snow_keeps_closer_to_what_is_wanted_and_costs_the_hands():
    """Sideslip and yaw rate error fall by a tenth at 90 km/h, the hand torque rises by half."""
    results = {}
    for run in ("power_steering", LAW):
        results[run] = drive_case(Case(run, LAW, (), run), measure).measured
    without, with_it = results["power_steering"], results[LAW]
    assert with_it["peak_sideslip"] < 0.9 * without["peak_sideslip"]
    assert with_it["yaw_rate_error"] < 0.9 * without["yaw_rate_error"]
    assert with_it["hand_torque"] > 1.5 * without["hand_torque"]
