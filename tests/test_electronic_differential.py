"""Electronic differentials: the splits, and the three concepts of Shchur (2019) on their steering columns."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_control.asr.off import Off
from ev_control.electronic_differential.drive_by_wire import DriveByWire
from ev_control.electronic_differential.equal_torque import EqualTorque
from ev_control.electronic_differential.power_steering import PowerSteering
from ev_control.electronic_differential.steer_by_wire import SteerByWire
from ev_control.electronic_differential.torque_split import BrakeSplitParameters
from ev_msgs_py.methods import find_method
from ev_msgs_py.signals import (
    DriverCommand,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_sim.steering_column.by_wire import ByWireColumn
from ev_sim.steering_column.powered import PoweredColumn

CAR = Vehicle()
PERIOD = 0.001
LAWS = (EqualTorque, PowerSteering, SteerByWire, DriveByWire)
LEVER = 1.462 / (2 * 0.294)  # d/(2 r_k)
J, B, K = 2.8, 7.5, 65.0
CENTRED = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)


def law_of(kind: type, car: Vehicle = CAR, **changed):
    return kind(dataclasses.replace(kind.parameters(), **changed), car, PERIOD)


def step(law, driver: DriverCommand, column: SteeringColumnState) -> WheelTorqueRequest:
    return law.step(driver) if isinstance(law, EqualTorque) else law.step(driver, column)


def difference(request: WheelTorqueRequest) -> float:
    return request.drive.front_right - request.drive.front_left


def drive(column, law, hand_torque: float, duration: float, disturbance: float = 0.0):
    """Column and law alone: the torques act at once; road-wheel angles [rad] and torque differences [N m] over time.

    `disturbance` is a torque difference [N m] that the law does not know of.
    """
    angles, differences = [], []
    for _ in range(round(duration / PERIOD) + 1):
        (state,) = column.outputs()
        driver = DriverCommand(0.0, 0.0, hand_torque)
        request = law.step(driver, state)
        angles.append(state.road_wheel_angle)
        differences.append(difference(request))
        left, right = request.drive.front_left, request.drive.front_right
        column.advance(driver, WheelStates(NO_WHEELS, NO_WHEELS, Wheels.front(left, right + disturbance)))
    return np.array(angles), np.array(differences)


def powered() -> PoweredColumn:
    return PoweredColumn(PoweredColumn.parameters(), CAR, PERIOD)


class HeldSteeringWheel(ByWireColumn):
    """The column by wire whose steering wheel is held at an angle."""

    def __init__(self, angle: float, **changed: float) -> None:
        super().__init__(dataclasses.replace(ByWireColumn.parameters(), **changed), CAR, PERIOD)
        self.held = angle
        self.state.angle = angle

    def advance(self, driver: DriverCommand, wheels: WheelStates) -> None:
        super().advance(driver, wheels)
        self.state.angle, self.state.rate = self.held, 0.0


# The split


@pytest.mark.parametrize("name", ["equal_torque", "power_steering", "steer_by_wire", "drive_by_wire"])
def test_laws_are_registered_and_rest_with_the_driver(name):
    law = find_method("electronic_differential", name)
    made = law.factory(law.parameters(), CAR, PERIOD)
    assert step(made, DriverCommand(0.0, 0.0, 0.0), CENTRED) == WheelTorqueRequest(NO_WHEELS, NO_WHEELS)


def test_equal_torque_on_every_layout():
    driver = DriverCommand(120.0, 0.0, 0.0)
    layouts = {
        ("front_left", "front_right"): Wheels.front(60.0, 60.0),
        ("rear_left", "rear_right"): Wheels.rear(60.0, 60.0),
        WHEEL_NAMES: Wheels.all(30.0),
        ("rear_left",): Wheels.rear(120.0, 0.0),
    }
    for driven, expected in layouts.items():
        assert law_of(EqualTorque, Vehicle(driven_wheels=driven)).step(driver).drive == expected


def test_equal_torque_without_driven_wheels_is_refused():
    with pytest.raises(ValueError, match=r"^vehicle audi_a2 has no driven wheels, at least one is needed$"):
        law_of(EqualTorque, Vehicle(driven_wheels=()))


@pytest.mark.parametrize("kind", [PowerSteering, SteerByWire, DriveByWire])
@pytest.mark.parametrize("driven", [("rear_left", "rear_right"), ("front_left",), ()])
def test_steering_laws_refuse_a_car_without_two_front_drives(kind, driven):
    with pytest.raises(ValueError, match="needs front_left and front_right among the driven wheels, vehicle audi_a2"):
        law_of(kind, Vehicle(driven_wheels=driven))


def test_all_wheel_drive_keeps_the_difference_on_the_front_axle():
    """Hand torque 1 N m: Delta M = (2 r_k i/d) gamma = 32.17 N m, half of it to each side of 25 N m per wheel."""
    law = law_of(PowerSteering, Vehicle(driven_wheels=WHEEL_NAMES))
    request = law.step(DriverCommand(100.0, 0.0, 1.0), SteeringColumnState(0.0, 0.0, 1.0, 0.0, 0.0))
    half = 16 * 5 / LEVER / 2
    assert request.drive == pytest.approx((25 - half, 25 + half, 25, 25), rel=1e-14)


def test_brakes_by_the_front_share():
    for law in (law_of(kind, brake=BrakeSplitParameters(front_share=0.75)) for kind in LAWS):
        request = step(law, DriverCommand(0.0, 800.0, 0.0), CENTRED)
        assert request.brake == Wheels(300.0, 300.0, 100.0, 100.0)


numbers = st.floats(-1000.0, 1000.0)
columns = st.builds(
    SteeringColumnState,
    st.floats(-16.0, 16.0),
    st.floats(-50.0, 50.0),
    st.floats(-20.0, 20.0),
    st.floats(-1.0, 1.0),
    st.floats(-5.0, 5.0),
)
LAYOUTS = (("front_left", "front_right"), ("front_left", "front_right", "rear_left"), WHEEL_NAMES)


@given(
    torque=numbers,
    brake=st.floats(0.0, 10000.0),
    share=st.floats(0.0, 1.0),
    column=columns,
    driven=st.sampled_from(LAYOUTS),
)
@pytest.mark.parametrize("kind", LAWS)
def test_torques_add_up_to_what_the_driver_asks(kind, torque, brake, share, column, driven):
    """Drive and brake torques balance to rounding (1e-12 of the numbers involved), brakes are never negative."""
    law = law_of(kind, Vehicle(driven_wheels=driven), brake=BrakeSplitParameters(front_share=share))
    request = step(law, DriverCommand(torque, brake, column.hand_torque), column)
    assert sum(request.drive) == pytest.approx(torque, abs=1e-12 * (abs(torque) + abs(difference(request)) + 1))
    assert sum(request.brake) == pytest.approx(brake, rel=1e-12)
    assert min(request.brake) >= 0.0
    assert all(value == 0.0 for name, value in request.drive._asdict().items() if name not in driven)


@given(torque=numbers, sequence=st.lists(columns, min_size=1, max_size=10))
@pytest.mark.parametrize("kind", LAWS)
def test_laws_mirror_to_the_bit(kind, torque, sequence):
    law, mirror = law_of(kind), law_of(kind)
    for column in sequence:
        mirrored = SteeringColumnState(*(-value for value in column))
        here = step(law, DriverCommand(torque, 0.0, column.hand_torque), column).drive
        there = step(mirror, DriverCommand(torque, 0.0, mirrored.hand_torque), mirrored).drive
        assert (here.front_left, here.front_right) == (there.front_right, there.front_left)


# Power steering


def test_power_steering_is_equation_4():
    """Delta M = (2 r_k i/d) (5 M_b - 0.051 alpha - 0.062 alpha') with M_b = 2, alpha = 3, alpha' = -4; by hand."""
    request = law_of(PowerSteering).step(DriverCommand(0.0, 0.0, 9.0), SteeringColumnState(3.0, -4.0, 2.0, 0.0, 0.0))
    assert difference(request) == pytest.approx(2 * 0.294 * 16 / 1.462 * (10 - 0.153 + 0.248), rel=1e-14)


def test_closed_loop_reaches_the_values_that_follow_from_the_paper():
    """Fig 1a, curve 2, M_b = 1 N m: 1.2299 rad, overshoot 1.7 %, 5 % settling 0.63 s.

    Bands: steady 0.5 %, overshoot 1 point, settling 5 %. Fig 1b: the difference begins with
    (2 r_k i/d) gamma = 32.2 N m and ends with (2 r_k/d)(gamma i - i^2 k_ck 1.2299) = 25.7 N m.
    """
    angle, torque = drive(powered(), law_of(PowerSteering), hand_torque=1.0, duration=10.0)
    assert angle[-1] == pytest.approx(1.2299, rel=0.005)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(1.7, abs=1.0)
    outside = np.flatnonzero(abs(angle / angle[-1] - 1) > 0.05)
    assert (outside[-1] + 1) * PERIOD == pytest.approx(0.63, rel=0.05)
    assert torque.max() == pytest.approx(16 * 5 / LEVER, rel=0.005)
    assert torque[-1] == pytest.approx((80 - 256 * 0.051 * 1.2299) / LEVER, rel=0.005)


def test_closed_loop_follows_the_exact_step_response():
    """Eq 7 by scipy.

    The assistance is late by 1 ms (the sensor) and half a period (the hold): with the fastest motion of 3.6 rad/s that
    is 5.4 mrad at most.
    """
    angle, _ = drive(powered(), law_of(PowerSteering), hand_torque=1.0, duration=3.0)
    time = np.arange(angle.size) * PERIOD
    stiffness, damping = K + 256 * 0.051, B + 256 * 0.062
    _, exact = scipy.signal.step(scipy.signal.TransferFunction([6 * 16.0], [J, damping, stiffness]), T=time)
    fastest = np.diff(exact).max() / PERIOD
    assert fastest < 3.6
    assert abs(angle - exact).max() < fastest * 1.5 * PERIOD


def test_holding_30_degrees_assisted():
    """0.426 N m at the steering wheel with 10.95 N m between the wheels; the digits printed, 0.5 %."""
    angle, torque = drive(powered(), law_of(PowerSteering), hand_torque=0.426, duration=10.0)
    assert math.degrees(angle[-1]) == pytest.approx(30.0, rel=0.005)
    assert torque[-1] == pytest.approx(10.95, rel=0.005)


def test_virtual_spring_and_damper_bring_the_wheels_back():
    """Let go at 0.5 rad, eq 5 is damped with 0.79 of critical: it passes zero by e^(-pi 0.79/0.61) = 1.7 %."""
    column = powered()
    column.state.road_wheel_angle = 0.5
    angle, _ = drive(column, law_of(PowerSteering), hand_torque=0.0, duration=5.0)
    assert angle.min() > -0.5 * 0.018
    # e^(-4.17 t) of the envelope leaves 1e-9 after 5 s.
    assert abs(angle[-1]) < 1e-8


# Steer by wire


def test_steer_by_wire_servo_is_the_second_order_system_of_its_parameters():
    """w_0^2/(s^2 + 2 D w_0 s + w_0^2) by scipy: the zero cancels the integral's pole.

    The torque is held, half a period late on average, so the damping is off by about w_0 T/2 = 0.4 %, and the angle by
    less than 0.5 % of its step.
    """
    p = SteerByWire.parameters()
    angle, _ = drive(HeldSteeringWheel(16 * 0.5), law_of(SteerByWire), hand_torque=0.0, duration=3.0)
    w_0 = p.natural_frequency
    servo = scipy.signal.TransferFunction([w_0**2], [1.0, 2 * p.damping_ratio * w_0, w_0**2])
    _, exact = scipy.signal.step(servo, T=np.arange(angle.size) * PERIOD)
    assert abs(angle - 0.5 * exact).max() < 0.005 * 0.5


@pytest.mark.parametrize("changed", [{}, {"stiffness": 130.0}, {"dry_friction": 5.0}, {"inertia": 4.0}])
def test_steer_by_wire_needs_no_exact_knowledge(changed):
    """Twice the stiffness, friction, more inertia and a torque of 5 N m unknown to the law: the angle is met.

    Ten seconds are 20 time constants of the integral action (e^-20); with dry friction the last bit sticks, and it
    takes the integral longer: 0.1 %.
    """
    column = HeldSteeringWheel(16 * 0.5, **changed)
    angle, _ = drive(column, law_of(SteerByWire), hand_torque=0.0, duration=10.0, disturbance=5.0)
    assert angle[-1] == pytest.approx(0.5, rel=1e-3)


def test_steer_by_wire_recovers_from_its_limit():
    """25 N m hold 0.8 rad only to 62 N m/65 = 0.96 rad: a steering wheel at 1.5 rad drives it into the limit for 20 s.

    Turned back to 0.5 rad, the wheels get there as fast as from rest: no wound-up integral. 5 %: the way is longer.
    """
    law, column = law_of(SteerByWire, max_torque_difference=25.0), HeldSteeringWheel(16 * 1.5)
    angle, torque = drive(column, law, hand_torque=0.0, duration=20.0)
    assert abs(torque).max() <= 25.0 * (1 + 1e-15)
    assert angle[-1] == pytest.approx(LEVER * 25.0 / K, rel=1e-3)
    column.held = column.state.angle = 16 * 0.5
    angle, _ = drive(column, law, hand_torque=0.0, duration=2.0)
    assert abs(angle[-1] - 0.5) < 0.05 * 0.5


# Drive by wire


def test_drive_by_wire_is_open_loop():
    """Delta M = k alpha whatever the road wheels do."""
    law = law_of(DriveByWire, gain=2.0)
    for road_wheel_angle in (0.0, 0.7):
        state = SteeringColumnState(3.0, 5.0, 1.0, road_wheel_angle, 0.0)
        assert difference(law.step(DriverCommand(50.0, 0.0, 1.0), state)) == 6.0


def test_drive_by_wire_settles_where_the_steering_wheel_points():
    """The default gain is 2 r_k k_p/(d i), rounded to four digits; the object's own overshoot of 40.3 % remains."""
    angle, _ = drive(HeldSteeringWheel(16 * 0.5), law_of(DriveByWire), hand_torque=0.0, duration=15.0)
    assert angle[-1] == pytest.approx(0.5, rel=5e-4)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(40.3, abs=1.0)


# No traction control


@given(st.tuples(*[numbers] * 4), st.tuples(*[numbers] * 4))
@settings(max_examples=20)
def test_asr_off_passes_everything_through(torques, brakes):
    request = WheelTorqueRequest(Wheels(*torques), Wheels(*brakes))
    assert Off(Off.parameters(), CAR, PERIOD).step(request) == WheelTorqueCommand(request.drive, request.brake)
