"""Shchur's traction model: motion under drive torques, resistance and brakes (eq 13)."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from plant.kinematic.car import (
    AUDI,
    COAST,
    KINEMATIC,
    PERIOD,
    ROLLING_TORQUE,
    WITHOUT_DRAG,
    Car,
    brake,
    torque,
)

from ev_core.methods.method_record import create
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import (
    BodyPose,
    InertialMeasurement,
    MotorStates,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_sim.drives.drive import DRIVE_MODELS


def test_outputs_are_what_the_plant_declares_and_its_role_allows():
    outputs = create(KINEMATIC, KINEMATIC.parameters(), AUDI, PERIOD).outputs()
    assert tuple(type(signal) for signal in outputs) == KINEMATIC.writes
    assert set(KINEMATIC.writes) <= set(ROLES["plant"].writes)
    numbers = [
        x
        for signal in outputs
        for value in signal
        for x in (value if type(value) is Wheels else [value])
    ]
    assert {type(number) for number in numbers} == {float}


@pytest.mark.parametrize("drive", DRIVE_MODELS)
def test_car_at_rest_stays_at_rest(drive):
    car = Car(drive=drive).drive(steps=500, degrees=20.0)
    assert car.speed == 0.0
    assert car[WheelStates].position == NO_WHEELS
    assert car[BodyPose] == BodyPose.at(0.0, 0.0, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_rolling_resistance_holds_the_car_up_to_its_full_value_and_not_beyond(sign):
    """Eq 13 as dry friction: 60.57 N m at the wheels."""
    assert Car().drive(torque(sign * 0.999 * ROLLING_TORQUE), steps=200).speed == 0.0
    assert sign * Car().drive(torque(sign * 1.001 * ROLLING_TORQUE)).speed > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_constant_torque_accelerates_evenly_from_rest(sign):
    """V = (M/r_k - F_roll)/m t without drag, x = V t/2; rounding only."""
    car = Car(WITHOUT_DRAG).drive(torque(sign * 500.0), steps=300)
    acceleration = sign * (500.0 - ROLLING_TORQUE) / 0.294 / 1400.0
    assert car.speed == pytest.approx(acceleration * 3.0, rel=1e-12)
    assert car[BodyPose].x == pytest.approx(acceleration * 4.5, rel=1e-12)
    assert car[WheelStates].velocity.rear_left == pytest.approx(
        acceleration * 3.0 / 0.294, rel=1e-12
    )
    assert car[WheelStates].position.front_right == pytest.approx(
        acceleration * 4.5 / 0.294, rel=1e-12
    )
    assert car[InertialMeasurement].longitudinal_acceleration == pytest.approx(
        acceleration, rel=1e-9
    )


def test_coasting_down_follows_the_closed_solution_of_eq_13():
    """V = V_c tan(arctan(V_0/V_c) - sqrt(F_roll c) t/m) solves m V' = -F_roll - c V^2 from 20 m/s.

    The drag is taken at the start of each sub-step, so the error is of first order: 1.4e-6 at 1 ms,
    half at 0.5 ms.
    """
    friction, drag = ROLLING_TORQUE / 0.294, 0.5 * 1.24 * 0.3 * 2.1
    critical = math.sqrt(friction / drag)
    exact = critical * math.tan(
        math.atan(20.0 / critical) - math.sqrt(friction * drag) * 20.0 / 1400.0
    )
    coarse = Car(initial_speed=20.0).drive(steps=2000).speed - exact
    fine = Car(initial_speed=20.0, sub_step=0.5e-3).drive(steps=2000).speed - exact
    assert abs(coarse) < 2e-6 * exact
    assert fine == pytest.approx(coarse / 2, rel=0.01)


@pytest.mark.parametrize("reading", ["added", "relative"])
@pytest.mark.parametrize("speed", [20.0, -20.0])
def test_rolling_resistance_grows_with_the_speed_as_drag_does(reading, speed):
    """M g k V^2 slows the car as drag 0.5 rho c_d A V^2 of the same factor.

    The relative reading has V in km/h and multiplies f_0. Only where the two are added differs:
    friction is exact within a sub-step, drag is that of its start, so bits may differ by rounding.
    """
    factor = 0.5 * 1.24 * 0.3 * 2.1
    growth = factor / (1400.0 * 9.81)
    if reading == "relative":
        growth /= 0.015 * 3.6**2
    rolling = replace(
        WITHOUT_DRAG, rolling_resistance_speed=growth, rolling_resistance_reading=reading
    )
    slowed = Car(rolling, initial_speed=speed).drive(steps=1000).speed
    assert slowed == pytest.approx(Car(AUDI, initial_speed=speed).drive(steps=1000).speed, rel=1e-9)
    unslowed = Car(WITHOUT_DRAG, initial_speed=speed).drive(steps=1000).speed
    assert abs(slowed) < 0.97 * abs(unslowed)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("drives", [True, False])
def test_the_gears_take_their_share_of_what_drives_and_of_what_brakes(sense, drives):
    """A torque M drives by 0.9 M; braking, wheel and road have to turn the motor through the gear.

    So M brakes by M/0.9. Rounding only, for ideal drives have no lag.
    """
    car = replace(WITHOUT_DRAG, motor=replace(AUDI.motor, gear_efficiency=0.9))
    asked = sense * (400.0 if drives else -400.0)
    behind = asked * 0.9 if drives else asked / 0.9
    driven = Car(car, initial_speed=sense * 10.0).drive(torque(asked), steps=50)
    expected = Car(WITHOUT_DRAG, initial_speed=sense * 10.0).drive(torque(behind), steps=50)
    assert driven.speed == pytest.approx(expected.speed, rel=1e-12)
    assert driven[WheelStates].effort.front_left == pytest.approx(behind / 2, rel=1e-12)
    # The motor itself gives what was asked, at its shaft.
    assert driven[MotorStates].effort.front_left * AUDI.gear_ratio == pytest.approx(
        asked / 2, rel=1e-12
    )


@pytest.mark.parametrize("drive", DRIVE_MODELS)
@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_brakes_bring_the_car_to_rest_and_hold_it(drive, speed):
    """Rest is exact and lasts, released brakes included.

    V^2/(2 a) without drag is met up to rounding (ideal drive).
    """
    car = Car(WITHOUT_DRAG, drive=drive, initial_speed=speed).drive(brake(2000.0), steps=400)
    assert car.speed == 0.0
    stopped = car[BodyPose]
    if drive == "ideal":
        deceleration = (2000.0 + ROLLING_TORQUE) / 0.294 / 1400.0
        assert stopped.x == pytest.approx(
            math.copysign(speed**2 / (2 * deceleration), speed), rel=1e-12
        )
    car.drive(brake(2000.0), steps=100).drive(COAST, steps=100)
    assert car.speed == 0.0
    assert car[BodyPose] == stopped
    assert car[InertialMeasurement].longitudinal_acceleration == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_brakes_hold_against_the_drives(sign):
    held = WheelTorqueCommand(Wheels.front(sign * 300.0, sign * 300.0), Wheels.all(150.0))
    assert Car().drive(held, steps=100).speed == 0.0
    assert sign * Car().drive(held._replace(brake=Wheels.all(100.0)), steps=100).speed > 0.0


@given(
    st.floats(-40, 40), st.lists(st.floats(0, 5000), min_size=1, max_size=30), st.floats(-60, 60)
)
def test_resistance_never_speeds_the_car_up_or_turns_it_round(speed, brakes, degrees):
    car = Car(initial_speed=speed)
    for total in brakes:
        before = car.speed
        after = car.drive(brake(total), degrees=degrees, steps=5).speed
        assert after * speed >= 0.0
        assert abs(after) <= abs(before) * (1 + 1e-15)  # hypot of the components rounds


def test_drives_stop_a_reversing_car_and_pull_it_away_forwards():
    """The sign changes once; the acceleration steps there by twice f_0 g."""
    car = Car(WITHOUT_DRAG, initial_speed=-2.0)
    speeds = [car.speed] + [car.drive(torque(500.0)).speed for _ in range(400)]
    accelerations = [(b - a) / PERIOD for a, b in pairwise(speeds)]
    assert speeds == sorted(speeds)
    assert accelerations[0] == pytest.approx((500.0 + ROLLING_TORQUE) / 0.294 / 1400.0, rel=1e-9)
    assert accelerations[-1] == pytest.approx((500.0 - ROLLING_TORQUE) / 0.294 / 1400.0, rel=1e-9)
