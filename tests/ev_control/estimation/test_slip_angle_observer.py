"""Slip angles of the axles, true and estimated."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from helpers.differentials import ZHILEYKIN, Motion
from hypothesis import assume, given
from hypothesis import strategies as st

from ev_control.estimation.plausible import Sensors
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    axle_slip_angles,
    observed_slip_angles,
)
from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.wheels import Wheels

CAR = namespace(car_numbers(ZHILEYKIN))
PERIOD = 0.01


def test_axle_slip_angles_by_hand():
    """Motion u = 10, v = 1, r = 0.2, arms 1.35 m: d1 = 0.1 - atan(0.127), d2 = -atan(0.073)."""
    front, rear = axle_slip_angles(CAR, 10.0, 1.0, 0.2, 0.1, 1.0)
    assert (front, rear) == pytest.approx((0.1 - math.atan(0.127), -math.atan(0.073)), rel=1e-14)


@given(
    u=st.floats(1.0, 50.0),
    v=st.floats(-5.0, 5.0),
    r=st.floats(-0.5, 0.5),
    delta=st.floats(-0.5, 0.5),
    ahead=st.sampled_from((1.0, -1.0)),
)
def test_slip_angles_are_how_far_the_wheels_move_aside_of_where_they_roll(u, v, r, delta, ahead):
    """Speed across the wheel over the speed along it, forwards and in reverse; arms are 1.35 m."""
    across = (v + 1.35 * r) * math.cos(delta) - ahead * u * math.sin(delta)
    along = ahead * u * math.cos(delta) + (v + 1.35 * r) * math.sin(delta)
    assume(ahead * along > 0.0)
    front, rear = axle_slip_angles(CAR, ahead * u, v, r, delta, 1.0)
    assert front == pytest.approx(-math.atan(across / abs(along)), abs=1e-12)
    assert rear == pytest.approx(-math.atan((v - 1.35 * r) / u), abs=1e-12)


@pytest.mark.parametrize("speed", [1.0, 10.0])
@pytest.mark.parametrize("delta", [0.3, -0.3])
def test_rolling_round_its_centre_in_reverse_a_car_has_no_slip_angles(speed, delta):
    """The least speed has the sign of the motion: at -10 m/s the slip angles are zero."""
    r = -speed * math.tan(delta) / ZHILEYKIN.wheelbase
    assert axle_slip_angles(CAR, -speed, 1.35 * r, r, delta, 1.0) == pytest.approx(
        (0.0, 0.0), abs=1e-15
    )


def test_slow_cars_have_the_slip_angles_of_the_least_speed():
    assert axle_slip_angles(CAR, 0.0, 1.0, 0.2, 0.1, 2.0) == axle_slip_angles(
        CAR, 2.0, 1.0, 0.2, 0.1, 2.0
    )


def bicycle(duration: float, angle: float, speed: float, stiffness: float) -> Iterator[Motion]:
    """Motions of a linear single-track car after a step of steering, explicit Euler at 1 kHz."""
    v = r = 0.0
    half, dt, ahead = 1.35, 0.001, math.copysign(1.0, speed)
    for k in range(round(duration / dt)):
        front = stiffness * (ahead * angle - (v + half * r) / abs(speed))
        rear = -stiffness * (v - half * r) / abs(speed)
        a_y = (front + rear) / 2400
        if k % 10 == 0:
            fl = ((speed - 0.775 * r) * math.cos(angle) + (v + half * r) * math.sin(angle)) / 0.35
            fr = ((speed + 0.775 * r) * math.cos(angle) + (v + half * r) * math.sin(angle)) / 0.35
            rim = Wheels(fl, fr, (speed - 0.775 * r) / 0.35, (speed + 0.775 * r) / 0.35)
            yield Motion(torque=ahead * 2400.0, speeds=rim, u=speed, v=v, r=r, a_y=a_y).steered(
                angle
            )
        v, r = v + dt * (a_y - r * speed), r + dt * half * (front - rear) / 4200


def observed(true_stiffness: float, speed: float = 15.0) -> tuple[float, float]:
    """Largest and last error of the slip angles in a step steer, over the largest angle [1]."""
    p, s = SlipAngleObserverParameters(), SlipAngleObserverState()
    errors, largest = [], 0.0
    for motion in bicycle(2.0, 0.02, speed, true_stiffness):
        _, driver, column, wheels, imu, body, _ = motion.signals().values()
        estimate = observed_slip_angles(p, CAR, s, PERIOD, driver, Sensors(column, wheels, imu))
        truth = axle_slip_angles(CAR, body.longitudinal, body.lateral, body.yaw_rate, 0.02, 1.0)
        errors.append(max(abs(e - t) for e, t in zip(estimate, truth, strict=True)))
        largest = max(largest, *(abs(t) for t in truth))
    return max(errors) / largest, errors[-1] / largest


@pytest.mark.parametrize("speed", [15.0, -15.0])
def test_observer_follows_a_step_steer_of_the_tyre_it_knows(speed):
    """Measured 4.4 % underway, most of it one period of v' (10 ms), and 0.4 % settled."""
    underway, settled = observed(160e3, speed)
    assert underway < 0.06
    assert settled < 0.01


def test_observer_cannot_see_a_slippery_road_in_a_steady_turn():
    """The axles slip twice as much with a tyre half as stiff, and the observer's tyre decides.

    It misses the rest.

    The rear axle's true slip angle is twice that of the stiffer tyre; the transient of two seconds
    is not over, and u comes with it, so only 30 to 55 % of the largest slip angle is asked.
    """
    _, settled = observed(80e3)
    assert 0.3 < settled < 0.55


@pytest.mark.parametrize("ahead", [1.0, -1.0])
@pytest.mark.parametrize(
    ("torque", "brake", "u"), [(100.0, 0.0, 10.0), (-100.0, 0.0, 14.0), (100.0, 50.0, 14.0)]
)
def test_speed_is_that_of_the_wheel_that_cannot_slip(torque, brake, u, ahead):
    """Wheels at 10 to 14 m/s, straight ahead and yawing at 0.1 rad/s without tracks' share.

    Slowest when driving.
    """
    narrow = namespace({**car_numbers(ZHILEYKIN), "front_track": 0.0, "rear_track": 0.0})
    speeds = Wheels(*(ahead * each / 0.35 for each in (10.0, 11.0, 12.0, 14.0)))
    motion = Motion(torque=ahead * torque, brake=brake, r=0.1, speeds=speeds)
    _, driver, column, wheels, imu, _, _ = motion.signals().values()
    s = SlipAngleObserverState()
    sensors = Sensors(column, wheels, imu)
    found = observed_slip_angles(SlipAngleObserverParameters(), narrow, s, PERIOD, driver, sensors)
    assert found == pytest.approx(
        axle_slip_angles(CAR, ahead * u, s.lateral_velocity, 0.1, 0.0, 1.0), rel=1e-12
    )
