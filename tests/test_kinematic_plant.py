"""Shchur's traction model: motion under drive torques, resistance and brakes, on wheels that roll without slip."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.parameters import build
from ev_msgs_py.roles import ROLES
from ev_msgs_py.signals import (
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, Wheels
from ev_sim.drives.drive import DRIVES
from ev_sim.plant.kinematic import KinematicPlant, KinematicPlantParameters

PERIOD = 0.01
AUDI = Vehicle()
WITHOUT_DRAG = replace(AUDI, drag_coefficient=0.0)
WITHOUT_RESISTANCE = replace(WITHOUT_DRAG, rolling_resistance=0.0)
ROLLING_TORQUE = 0.015 * 1400.0 * 9.81 * 0.294  # rolling resistance as a torque at the wheels [N m], eq 13
COAST = WheelTorqueCommand(NO_WHEELS)


class Car:
    """A plant with its outputs by signal type."""

    def __init__(self, vehicle=AUDI, **parameters):
        self.plant = KinematicPlant(build(KinematicPlantParameters, parameters), vehicle, PERIOD)

    def drive(self, command=COAST, *, degrees=0.0, steps=1):
        column = SteeringColumnState(0.0, 0.0, 0.0, math.radians(degrees), 0.0)
        for _ in range(steps):
            self.plant.advance(command, column)
        return self

    def __getitem__(self, signal):
        return dict(zip(self.plant.writes, self.plant.outputs(), strict=True))[signal]

    @property
    def speed(self):
        velocity = self[BodyVelocity]
        return math.copysign(math.hypot(velocity.longitudinal, velocity.lateral), velocity.longitudinal)


def torque(total):
    """A drive torque shared by the front wheels."""
    return WheelTorqueCommand(Wheels.front(total / 2, total / 2))


def brake(total):
    return WheelTorqueCommand(NO_WHEELS, Wheels.all(total / 4))


def brake_of(**wheels):
    return WheelTorqueCommand(NO_WHEELS, NO_WHEELS._replace(**wheels))


def test_outputs_are_what_the_plant_declares_and_its_role_allows():
    outputs = Car().plant.outputs()
    assert tuple(type(signal) for signal in outputs) == KinematicPlant.writes
    assert set(KinematicPlant.writes) <= set(ROLES["plant"].writes)
    numbers = [x for signal in outputs for value in signal for x in (value if type(value) is Wheels else [value])]
    assert {type(number) for number in numbers} == {float}


@pytest.mark.parametrize("drive", DRIVES)
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
    assert car[WheelStates].velocity.rear_left == pytest.approx(acceleration * 3.0 / 0.294, rel=1e-12)
    assert car[WheelStates].position.front_right == pytest.approx(acceleration * 4.5 / 0.294, rel=1e-12)
    assert car[InertialMeasurement].longitudinal_acceleration == pytest.approx(acceleration, rel=1e-9)


def test_coasting_down_follows_the_closed_solution_of_eq_13():
    """V = V_c tan(arctan(V_0/V_c) - sqrt(F_roll c) t/m) solves m V' = -F_roll - c V^2 from 20 m/s.

    The drag is taken at the start of each sub-step, so the error is of first order: 1.4e-6 at 1 ms, half at 0.5 ms.
    """
    friction, drag = ROLLING_TORQUE / 0.294, 0.5 * 1.24 * 0.3 * 2.1
    critical = math.sqrt(friction / drag)
    exact = critical * math.tan(math.atan(20.0 / critical) - math.sqrt(friction * drag) * 20.0 / 1400.0)
    coarse = Car(initial_speed=20.0).drive(steps=2000).speed - exact
    fine = Car(initial_speed=20.0, sub_step=0.5e-3).drive(steps=2000).speed - exact
    assert abs(coarse) < 2e-6 * exact
    assert fine == pytest.approx(coarse / 2, rel=0.01)


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_brakes_bring_the_car_to_rest_and_hold_it(drive, speed):
    """Rest is exact and lasts, released brakes included; V^2/(2 a) without drag is met up to rounding (ideal drive)."""
    car = Car(WITHOUT_DRAG, drive=drive, initial_speed=speed).drive(brake(2000.0), steps=400)
    assert car.speed == 0.0
    stopped = car[BodyPose]
    if drive == "ideal":
        deceleration = (2000.0 + ROLLING_TORQUE) / 0.294 / 1400.0
        assert stopped.x == pytest.approx(math.copysign(speed**2 / (2 * deceleration), speed), rel=1e-12)
    car.drive(brake(2000.0), steps=100).drive(COAST, steps=100)
    assert car.speed == 0.0
    assert car[BodyPose] == stopped
    assert car[InertialMeasurement].longitudinal_acceleration == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_brakes_hold_against_the_drives(sign):
    held = WheelTorqueCommand(Wheels.front(sign * 300.0, sign * 300.0), Wheels.all(150.0))
    assert Car().drive(held, steps=100).speed == 0.0
    assert sign * Car().drive(held._replace(brake=Wheels.all(100.0)), steps=100).speed > 0.0


@settings(max_examples=50, deadline=None)
@given(st.floats(-40, 40), st.lists(st.floats(0, 5000), min_size=1, max_size=30), st.floats(-60, 60))
def test_resistance_never_speeds_the_car_up_or_turns_it_round(speed, brakes, degrees):
    car = Car(initial_speed=speed)
    for total in brakes:
        before = car.speed
        after = car.drive(brake(total), degrees=degrees, steps=5).speed
        assert after * speed >= 0.0
        assert abs(after) <= abs(before) * (1 + 1e-15)  # hypot of the components rounds


def test_drives_stop_a_reversing_car_and_pull_it_away_forwards():
    """The sign changes once and the acceleration steps by twice the rolling resistance over the mass there."""
    car = Car(WITHOUT_DRAG, initial_speed=-2.0)
    speeds = [car.speed] + [car.drive(torque(500.0)).speed for _ in range(400)]
    accelerations = [(b - a) / PERIOD for a, b in pairwise(speeds)]
    assert speeds == sorted(speeds)
    assert accelerations[0] == pytest.approx((500.0 + ROLLING_TORQUE) / 0.294 / 1400.0, rel=1e-9)
    assert accelerations[-1] == pytest.approx((500.0 - ROLLING_TORQUE) / 0.294 / 1400.0, rel=1e-9)


@pytest.mark.parametrize(
    ("kilometres_per_hour", "degrees", "difference"), [(15, 30, 1.222), (30, -30, -2.444), (-15, 30, -1.222)]
)
def test_difference_of_the_wheel_speeds_in_the_two_turns(kilometres_per_hour, degrees, difference):
    """Eq 12: V_R - V_L at the speed V of the centre of mass; half a unit of the last digit given."""
    car = Car(WITHOUT_RESISTANCE, initial_speed=kilometres_per_hour / 3.6).drive(degrees=degrees)
    wheels = car[WheelStates].velocity
    assert 0.294 * (wheels.front_right - wheels.front_left) == pytest.approx(difference, abs=5e-4)
    assert car.speed == pytest.approx(kilometres_per_hour / 3.6, rel=1e-12)


def test_emf_of_the_outer_motor_in_the_second_turn():
    """2 p psi omega with the gear of 2.65: 381 V between two phases, to the last digit given."""
    car = Car(WITHOUT_RESISTANCE, initial_speed=30 / 3.6).drive(degrees=-30.0)
    assert 2 * 10 * 0.2 * car[MotorStates].velocity.front_left == pytest.approx(381.0, abs=0.5)


@pytest.mark.parametrize("degrees", [30.0, -30.0, 5.0])
def test_held_angle_drives_a_circle(degrees):
    """Radius of eq 11 about a fixed centre, V^2/R towards it; arcs are exact, so only rounding adds up."""
    car = Car(WITHOUT_RESISTANCE, initial_speed=5.0)
    cot = 1 / math.tan(math.radians(degrees))
    radius = math.copysign(2.405 * math.hypot(cot, 0.45), degrees)
    turn = round(abs(math.tau * radius) / 5.0 / PERIOD)
    for _ in range(turn):
        pose = car.drive(degrees=degrees)[BodyPose]
        # The centre lies on the line of the rear axle, abeam of a point 1.08225 m behind the centre of mass.
        centre_x = pose.x - 1.08225 * math.cos(pose.heading) - 2.405 * cot * math.sin(pose.heading)
        centre_y = pose.y - 1.08225 * math.sin(pose.heading) + 2.405 * cot * math.cos(pose.heading)
        assert (centre_x, centre_y) == pytest.approx((-1.08225, 2.405 * cot), abs=1e-9)
    body, imu = car[BodyVelocity], car[InertialMeasurement]
    assert imu.yaw_rate == body.yaw_rate == pytest.approx(5.0 / radius, rel=1e-9)
    towards_centre = (-body.lateral / 5.0, body.longitudinal / 5.0)
    acceleration = (imu.longitudinal_acceleration, imu.lateral_acceleration)
    assert acceleration == pytest.approx(tuple(25.0 / radius * n for n in towards_centre), rel=1e-9)


@pytest.mark.parametrize("drive", DRIVES)
def test_mirrored_commands_give_a_mirrored_car_to_the_last_bit(drive):
    def run(mirror):
        car = Car(drive=drive, initial_speed=3.0)
        for k in range(300):
            wheels = (100.0 + k / 5, 80.0 - k / 7)
            brakes = (0.0, 3.0, 5.0, 11.0 if k > 100 else 0.0)
            if mirror:
                wheels, brakes = wheels[::-1], (*brakes[1::-1], *brakes[:1:-1])
            car.drive(
                WheelTorqueCommand(Wheels.front(*wheels), Wheels(*brakes)),
                degrees=(-1 if mirror else 1) * 30.0 * math.sin(k / 50),
            )
        return car

    car, mirrored = run(False), run(True)
    for signal in (WheelStates, MotorStates):
        for wheels, others in zip(car[signal], mirrored[signal], strict=True):
            assert wheels == (others.front_right, others.front_left, others.rear_right, others.rear_left)
    pose, other = car[BodyPose], mirrored[BodyPose]
    assert (pose.x, pose.y, pose.orientation_z, pose.orientation_w) == (
        other.x,
        -other.y,
        -other.orientation_z,
        other.orientation_w,
    )
    assert car[BodyVelocity].longitudinal == mirrored[BodyVelocity].longitudinal
    assert car[InertialMeasurement].lateral_acceleration == -mirrored[InertialMeasurement].lateral_acceleration


@pytest.mark.parametrize("drive", DRIVES[1:])
def test_car_with_real_drives_moves_like_one_with_ideal_drives(drive):
    """To 15 km/h in 4 s; 1 % is what commutation takes from the torque up to this speed."""
    command = torque(1400.0 * 15 / 3.6 / 4 * 0.294 + ROLLING_TORQUE)
    ideal = Car(drive="ideal").drive(command, steps=400)
    assert ideal.speed == pytest.approx(15 / 3.6, rel=0.01)
    assert Car(drive=drive).drive(command, steps=400).speed == pytest.approx(ideal.speed, rel=0.01)


@pytest.mark.parametrize("drive", DRIVES[1:])
def test_second_turn_loses_current_control_on_a_bus_of_300_volt(drive):
    """34 N m at each front wheel carry the car through the second turn. 7 %: commutation at 95 rad/s.

    At 300 V the outer (left) motor brakes, the inner one, with an EMF of 293 V, still holds its torque at first.
    """

    def outer_torque(bus_voltage):
        car = Car(WITHOUT_RESISTANCE, drive=drive, bus_voltage=bus_voltage, initial_speed=30 / 3.6)
        return car.drive(torque(68.0), degrees=-30.0, steps=10)[WheelStates].effort.front_left

    assert outer_torque(480.0) == pytest.approx(34.0, rel=0.07)
    assert outer_torque(300.0) < -50.0


def test_wheel_torque_is_the_mean_over_the_period_and_motor_torque_is_the_one_now():
    """So the speed follows from the wheel torques to rounding, while the motor shows its chopping."""
    car = Car(WITHOUT_DRAG, drive="switched", initial_speed=4.0).drive(torque(300.0), steps=20)
    before = car.speed
    car.drive(torque(300.0))
    wheels, motors = car[WheelStates].effort, car[MotorStates].effort
    force = (sum(wheels) - ROLLING_TORQUE) / 0.294
    assert car.speed - before == pytest.approx(force / 1400.0 * PERIOD, rel=1e-9)
    assert wheels.front_left != pytest.approx(2.65 * motors.front_left, rel=1e-6)
    assert wheels.front_left == pytest.approx(2.65 * motors.front_left, rel=0.1)  # band of 0.5 A in 14 A, and a dip


def test_rear_drive_turns_the_rear_motors_only():
    car = Car(replace(AUDI, driven_wheels=("rear_left", "rear_right")))
    car.drive(WheelTorqueCommand(Wheels.rear(200.0, 200.0)), steps=10)
    assert car.speed > 0.0
    assert car[WheelStates].effort == pytest.approx(Wheels.rear(200.0, 200.0), rel=1e-12)
    assert car[MotorStates].velocity.front_left == 0.0 < car[MotorStates].velocity.rear_left


def moved(command):
    """The outputs of a rolling car a period later, and what it counted."""
    car = Car(initial_speed=5.0).drive(command)
    return car.plant.outputs(), tuple(car.plant.diagnostics.values())


@pytest.mark.parametrize(
    ("command", "accepted", "counts"),
    [
        (WheelTorqueCommand(Wheels(10.0, 10.0, 5.0, 0.0)), WheelTorqueCommand(Wheels.front(10.0, 10.0)), (0, 1)),
        (WheelTorqueCommand(NO_WHEELS, Wheels(0.0, -1.0, 0.0, 9e9)), brake_of(rear_right=4000.0), (0, 2)),
        (WheelTorqueCommand(Wheels.front(math.nan, -math.inf), Wheels.all(math.nan)), COAST, (6, 0)),
    ],
)
def test_impossible_commands_are_counted_and_not_taken(command, accepted, counts):
    """As in the planar plant: no torque at wheels without a motor, 0 for what is not finite, else the nearest limit."""
    assert moved(command) == (moved(accepted)[0], counts)


def test_an_angle_that_is_not_finite_keeps_the_last_one():
    car = Car(initial_speed=5.0).drive(degrees=10.0)
    again = Car(initial_speed=5.0).drive(degrees=10.0, steps=12)
    assert car.plant.reports() == ()
    car.drive(degrees=math.nan, steps=11)
    assert car.plant.outputs() == again.plant.outputs()
    assert car.plant.reports() == ("10 or more values of commands were not finite",)


def test_column_beyond_a_right_angle_does_no_harm():
    """The object of fig 1a overshoots to 98 deg with the car at rest."""
    car = Car().drive(degrees=98.9, steps=10)
    assert car.speed == 0.0
    assert all(math.isfinite(x) for x in car[WheelStates].velocity)
