"""Torques within what motors and battery can give: what stays, and what yields."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import pytest
from helpers.differentials import SHCHUR, Differential, Motion, on, wheels
from helpers.traction import car_of, numbers_of
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import ev_stack
from ev_control.shared.allocation import AllocationParameters, Keep, allocated, mechanical_power
from ev_core.vehicle.battery import Battery
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.synchronous_motor import limited_torque

TOLERANCE = 1e-9  # [N m], rounding of sums of torques up to 1e4 N m

motors = st.builds(
    Motor,
    peak_torque=st.floats(0.0, 800.0),
    peak_power=st.floats(1e3, 2e5),
    maximum_speed=st.floats(50.0, 2000.0),
    generator_torque=st.floats(0.0, 800.0),
    generator_power=st.floats(0.0, 2e5),
)
batteries = st.builds(
    Battery,
    discharge_power=st.floats(0.0, 3e5),
    charge_power=st.floats(0.0, 3e5),
    auxiliary_power=st.floats(0.0, 5e3),
)
gears = st.floats(0.5, 12.0)
cars = st.builds(
    Vehicle,
    gear_ratio=gears,
    driven_wheels=st.sampled_from(
        (WHEEL_NAMES, WHEEL_NAMES[:2], WHEEL_NAMES[2:], WHEEL_NAMES[:3], WHEEL_NAMES[2:3])
    ),
    motor=motors,
    battery=batteries,
    driveline=st.builds(
        Driveline, front_gear=gears, rear_gear=gears, rear_size=st.floats(0.2, 4.0)
    ),
)
torques = st.one_of(st.just(NO_WHEELS), wheels(-3000.0, 3000.0), wheels(-100.0, 100.0))
speeds = st.one_of(
    st.just(NO_WHEELS), wheels(-200.0, 200.0), st.floats(-200.0, 200.0).map(Wheels.all)
)
EFFICIENCY = AllocationParameters().efficiency


def given_to(car: Vehicle, keep: str, asked: Wheels, speed: Wheels) -> Wheels:
    """The drive torques [N m] of which as much as there are motors is asked."""
    request = WheelTorqueRequest(asked, NO_WHEELS)
    states = WheelStates(NO_WHEELS, speed, NO_WHEELS)
    return allocated(
        numbers_of(AllocationParameters(keep=Keep.of(keep))), car_of(car), states, request
    ).drive


def of_motors(car: Vehicle, torque: Wheels) -> Wheels:
    return Wheels(
        *(each if name in car.driven_wheels else 0.0 for name, each in torque._asdict().items())
    )


def as_the_plant_gives(car: Vehicle, torque: Wheels, speed: Wheels) -> Wheels:
    """Torques of cold motors for commands [N m]."""
    numbers = car_of(car)
    gear, count = numbers.gear, numbers.motors
    return Wheels(
        *(
            limited_torque(car.motor, torque[i] / gear[i] / count[i], speed[i] * gear[i], 0.0)
            * gear[i]
            * count[i]
            if numbers.driven[i]
            else 0.0
            for i in range(4)
        )
    )


def power_limits(car: Vehicle) -> tuple[float, float]:
    battery = car.battery
    give = EFFICIENCY * max(battery.discharge_power - battery.auxiliary_power, 0.0)
    return give, battery.charge_power + battery.auxiliary_power


def mirror(of: Wheels) -> Wheels:
    return Wheels(of[1], of[0], of[3], of[2])


def other_way_round(car: Vehicle) -> Vehicle:
    swapped = dict(zip(WHEEL_NAMES, mirror(Wheels(*WHEEL_NAMES)), strict=True))
    return on(car, tuple(name for name in WHEEL_NAMES if swapped[name] in car.driven_wheels))


@settings(max_examples=100, phases=(Phase.explicit, Phase.generate))
@given(car=cars, torque=torques, speed=speeds)
@pytest.mark.parametrize("keep", ["sum", "difference"])
def test_what_is_given_can_be_had_and_is_never_more_than_asked(keep, car, torque, speed):
    asked = of_motors(car, torque)
    drive = given_to(car, keep, asked, speed)
    give, take = power_limits(car)
    power = mechanical_power(drive, speed)
    rounding = TOLERANCE * (1.0 + max(abs(each) for each in speed))
    assert drive == pytest.approx(as_the_plant_gives(car, drive, speed), abs=TOLERANCE)
    assert -take - rounding <= power <= give + rounding
    assert abs(sum(drive)) <= abs(sum(asked)) + TOLERANCE
    assert given_to(other_way_round(car), keep, mirror(asked), mirror(speed)) == mirror(drive)
    possible = as_the_plant_gives(car, asked, speed) == pytest.approx(asked, abs=0.0)
    if possible and -take <= mechanical_power(asked, speed) <= give:
        assert drive == pytest.approx(asked, abs=TOLERANCE)  # the limits themselves are rounded


def test_a_battery_that_neither_gives_nor_takes_leaves_no_torque_that_has_power():
    """Limit and power of no torque are both zero, and neither is divided by the other."""
    car = Vehicle(
        driven_wheels=("rear_left", "rear_right"),
        battery=Battery(discharge_power=0.0, charge_power=0.0, auxiliary_power=0.0),
    )
    for torque in (-500.0, 500.0):
        drive = given_to(car, "sum", Wheels(0.0, 0.0, torque, torque), Wheels.all(20.0))
        assert mechanical_power(drive, Wheels.all(20.0)) == 0.0


@settings(max_examples=100, phases=(Phase.explicit, Phase.generate))
@given(car=cars, torque=torques, speed=speeds)
def test_sum_gives_no_wheel_the_other_sign_and_leaves_no_motor_idle(car, torque, speed):
    """Less than the sum is given, without a battery limit, only if no motor can give more."""
    asked = of_motors(car, torque)
    drive = given_to(car, "sum", asked, speed)
    assert all(one * other >= 0.0 for one, other in zip(drive, asked, strict=True))
    strong = dataclasses.replace(car, battery=Battery(discharge_power=1e7, charge_power=1e7))
    drive = given_to(strong, "sum", asked, speed)
    missing = sum(asked) - sum(drive)
    if abs(missing) > 1e-6:
        more = Wheels(*(each + missing for each in drive))
        for had, could, of in zip(drive, as_the_plant_gives(car, more, speed), asked, strict=True):
            assert of * missing < 0.0 or abs(could) <= abs(had) + 1e-6


@settings(max_examples=100, phases=(Phase.explicit, Phase.generate))
@given(car=cars, torque=torques, speed=speeds)
def test_difference_stays_wherever_some_sum_leaves_room(car, torque, speed):
    """Means, 101 of them, between none and the asked one.

    None may leave room for a difference that is not given.

    Of axles that work against each other one may have to yield with the other, for the sum of all.
    """
    strong = dataclasses.replace(car, battery=Battery(discharge_power=1e7, charge_power=1e7))
    asked = of_motors(car, torque)
    drive = given_to(strong, "difference", asked, speed)
    against = (asked[0] + asked[1]) * (asked[2] + asked[3]) < 0.0
    for left in (0, 2):
        wanted, had = asked[left + 1] - asked[left], drive[left + 1] - drive[left]
        assert had * wanted >= 0.0
        assert abs(had) <= abs(wanted) + TOLERANCE
        if abs(had - wanted) > 1e-6 and not against:
            for share in range(101):
                mean = share / 100.0 * (asked[left] + asked[left + 1]) / 2.0
                tried = list(drive)
                tried[left : left + 2] = (
                    mean - (had + 0.01 * (wanted - had)) / 2.0,
                    mean + (had + 0.01 * (wanted - had)) / 2.0,
                )
                could = as_the_plant_gives(car, Wheels(*tried), speed)
                wrong = [
                    one
                    for one, other in zip(tried, could, strict=True)
                    if abs(one - other) > TOLERANCE
                ]
                assert wrong


CAR = Vehicle(
    motor=Motor(peak_torque=250.0, generator_torque=150.0),
    gear_ratio=1.0,
    driven_wheels=WHEEL_NAMES,
)
SLOW = Wheels.all(1.0)


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_each_choice_by_hand(ahead):
    """Motors that drive with 250 and brake with 150 N m; the right one is asked for 330."""

    def choice(keep, *asked):
        speed = Wheels.all(ahead)
        drive = given_to(CAR, keep, Wheels(*(ahead * each for each in asked)), speed)
        return tuple(ahead * each for each in drive)

    asked = (100.0, 330.0, 50.0, 240.0)
    assert choice("asked", *asked) == asked
    assert choice("difference", *asked) == pytest.approx((20.0, 250.0, 50.0, 240.0))
    assert choice("sum", *asked) == pytest.approx((180.0, 250.0, 50.0, 240.0))
    # Its own axle is full: 30 and 50 N m go to the other one, of which one wheel has room for 10.
    assert choice("sum", 280.0, 300.0, 50.0, 240.0) == pytest.approx((250.0, 250.0, 120.0, 250.0))
    # A difference of 500 without a sum: 150 against the travel is all there is, and the partner
    # gives no more.
    assert choice("difference", -250.0, 250.0, 0.0, 0.0) == pytest.approx((-150.0, 150.0, 0.0, 0.0))
    assert choice("sum", -250.0, 250.0, 0.0, 0.0) == pytest.approx((-150.0, 150.0, 0.0, 0.0))


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_the_battery_takes_from_the_sum_before_it_takes_from_the_difference(ahead):
    """9 kW at 100 rad/s are 90 N m in all, with 60 N m between left and right."""
    car = dataclasses.replace(CAR, battery=Battery(discharge_power=10e3))
    speed, asked = (
        Wheels.all(100.0 * ahead),
        Wheels(*(ahead * each for each in (20.0, 80.0, 50.0, 50.0))),
    )
    drive = given_to(car, "difference", asked, speed)
    assert sum(drive) == pytest.approx(ahead * 90.0)
    assert drive[1] - drive[0] == pytest.approx(ahead * 60.0)
    assert given_to(car, "sum", asked, speed) == pytest.approx(tuple(0.45 * each for each in asked))


LAWS = (
    "adaptive",
    "adhesion_share",
    "drive_by_wire",
    "limited_slip",
    "limited_slip_variable",
    "load_proportional",
    "power_steering",
    "steer_by_wire",
    "steering_correction",
)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("keep", ["sum", "difference"])
def test_each_law_gives_what_motors_can_where_it_asked_for_more(name, keep):
    motion = Motion(torque=9000.0, speeds=Wheels(20.0, 30.0, 20.0, 30.0), a_y=3.0).steered(0.1)
    car = on(SHCHUR, WHEEL_NAMES)
    plain = Differential(name, car).step(motion).drive
    drive = (
        Differential(name, car, allocation=AllocationParameters(keep=Keep.of(keep)))
        .step(motion)
        .drive
    )
    assert as_the_plant_gives(car, plain, motion.speeds) != pytest.approx(plain, abs=1.0)
    assert as_the_plant_gives(car, drive, motion.speeds) == pytest.approx(drive, abs=TOLERANCE)


@pytest.mark.parametrize("name", ["power_steering", "limited_slip"])
def test_a_car_without_motors_of_its_wheels_is_refused(name):
    car = dataclasses.replace(on(SHCHUR, WHEEL_NAMES), driveline=Driveline(coupling="clutch"))
    Differential(name, car)
    with pytest.raises(
        ParameterError, match=r"needs a motor for each driven wheel for allocation\.keep sum"
    ):
        Differential(name, car, allocation=AllocationParameters(keep=Keep.SUM))


@pytest.mark.parametrize("keep", ["asked", "difference"])
def test_drives_that_steer_hold_25_m_s(keep):
    """6.25 m/s^2 in a bend of 100 m.

    6.9 m off its path it was, with 1083 N m asked of a motor that has 662.
    """
    values = {
        "plant.faults": [],
        "plant.initial_speed": 25.0,
        "driver.speed_profile.time": [0.0],
        "driver.speed_profile.speed": [25.0],
        "electronic_differential.allocation.keep": keep,
    }
    assert leaves_the_path(ev_stack.run("dead_motor", set=values).signals, 1.0) < 1.0


def leaves_the_path(signals: Mapping[str, np.ndarray], side: float) -> float:
    """Largest distance from 40 m straight on and a bend of 100 m [m]."""
    x, y = signals["pose.x"], side * signals["pose.y"]
    return float(abs(np.where(x > 40.0, 100.0 - np.hypot(x - 40.0, y - 100.0), y)).max())


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_drives_that_steer_keep_the_path_while_they_speed_up(side):
    """20 to 24 m/s within 2 s in a bend of 100 m.

    Sum and difference together are more than the outer motor has.

    Each motor on its own, the car leaves its path by 20 m; where the sum yields, by 0.9 m. Half a
    lane is 1.75 m.
    """
    leaves = {}
    for keep in ("asked", "difference"):
        values = {
            "plant.faults": [],
            "plant.initial_speed": 20.0,
            "driver.speed_profile.time": [0.0, 3.0, 5.0],
            "driver.speed_profile.speed": [20.0, 20.0, 24.0],
            "driver.path.curvature": [0.0, 0.01 * side],
            "electronic_differential.allocation.keep": keep,
        }
        leaves[keep] = leaves_the_path(
            ev_stack.run("dead_motor", set=values, duration=8.0).signals, side
        )
    assert leaves["asked"] > 10.0
    assert leaves["difference"] < 1.75
