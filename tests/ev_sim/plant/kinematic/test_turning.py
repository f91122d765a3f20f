"""Turns on Ackermann's radii about one centre (Shchur 2019, eqs 8 to 12)."""

import math
from dataclasses import replace

import pytest
from plant.kinematic.car import PERIOD, WITHOUT_RESISTANCE, Car

from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.signals import (
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.drive import DRIVE_MODELS


@pytest.mark.parametrize(
    ("kilometres_per_hour", "degrees", "difference"),
    [(15, 30, 1.222), (30, -30, -2.444), (-15, 30, -1.222)],
)
def test_difference_of_the_wheel_speeds_in_the_two_turns(kilometres_per_hour, degrees, difference):
    """Eq 12: V_R - V_L at the speed V of the centre of mass.

    Half a unit of the last digit given.
    """
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
    """Radius of eq 11 about a fixed centre, V^2/R towards it.

    Arcs are exact, so only rounding adds up.
    """
    car = Car(WITHOUT_RESISTANCE, initial_speed=5.0)
    cot = 1 / math.tan(math.radians(degrees))
    radius = math.copysign(2.405 * math.hypot(cot, 0.45), degrees)
    turn = round(abs(math.tau * radius) / 5.0 / PERIOD)
    for _ in range(turn):
        pose = car.drive(degrees=degrees)[BodyPose]
        # The centre lies on the line of the rear axle, abeam of a point 1.08225 m behind the centre
        # of mass.
        centre_x = pose.x - 1.08225 * math.cos(pose.heading) - 2.405 * cot * math.sin(pose.heading)
        centre_y = pose.y - 1.08225 * math.sin(pose.heading) + 2.405 * cot * math.cos(pose.heading)
        assert (centre_x, centre_y) == pytest.approx((-1.08225, 2.405 * cot), abs=1e-9)
    body, imu = car[BodyVelocity], car[InertialMeasurement]
    assert imu.yaw_rate == body.yaw_rate == pytest.approx(5.0 / radius, rel=1e-9)
    towards_centre = (-body.lateral / 5.0, body.longitudinal / 5.0)
    acceleration = (imu.longitudinal_acceleration, imu.lateral_acceleration)
    assert acceleration == pytest.approx(tuple(25.0 / radius * n for n in towards_centre), rel=1e-9)


@pytest.mark.parametrize("drive", DRIVE_MODELS)
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
            assert wheels == (
                others.front_right,
                others.front_left,
                others.rear_right,
                others.rear_left,
            )
    pose, other = car[BodyPose], mirrored[BodyPose]
    assert (pose.x, pose.y, pose.orientation_z, pose.orientation_w) == (
        other.x,
        -other.y,
        -other.orientation_z,
        other.orientation_w,
    )
    assert car[BodyVelocity].longitudinal == mirrored[BodyVelocity].longitudinal
    assert (
        car[InertialMeasurement].lateral_acceleration
        == -mirrored[InertialMeasurement].lateral_acceleration
    )


def test_column_beyond_a_right_angle_does_no_harm():
    """The object of fig 1a overshoots to 98 deg with the car at rest."""
    car = Car().drive(degrees=98.9, steps=10)
    assert car.speed == 0.0
    assert all(math.isfinite(x) for x in car[WheelStates].velocity)


@pytest.mark.parametrize(("driven", "more"), [("front", 0.1208), ("rear", -0.0320)])
def test_work_of_the_motors_in_a_bend_is_not_what_the_car_gets(driven, more):
    """Fig 3 adds M_j/r to the force on the point mass whatever M_j w_j is.

    docs/shchur2019.md has both numbers.

    (R_L + R_R)/2 over R of eqs 10 and 11 is 1.1208 in front and 0.9680 behind at 30 deg, without
    resistance.
    """
    wheels = tuple(f"{driven}_{side}" for side in ("left", "right"))
    car = Car(replace(WITHOUT_RESISTANCE, driven_wheels=wheels), initial_speed=5.0).drive(
        degrees=30.0
    )
    torques = Wheels.front(100.0, 100.0) if driven == "front" else Wheels(0.0, 0.0, 100.0, 100.0)
    start, before = car[WheelStates], car.speed
    car.drive(WheelTorqueCommand(torques), degrees=30.0, steps=200)
    turned = [
        sum(getattr(each.position, name) for name in wheels) for each in (start, car[WheelStates])
    ]
    gained = 0.5 * WITHOUT_RESISTANCE.mass * (car.speed**2 - before**2)
    assert 100.0 * (turned[1] - turned[0]) / gained - 1.0 == pytest.approx(more, abs=2e-4)


def test_front_wheels_of_one_angle_are_refused():
    """They turn about two centres, so one of them slips, which this plant does not know."""
    parallel = {"method": "kinematic", "vehicle.steering_geometry": "parallel"}
    with pytest.raises(ParameterError, match=r"needs vehicle\.steering_geometry ackermann"):
        configure("plant", parallel)
