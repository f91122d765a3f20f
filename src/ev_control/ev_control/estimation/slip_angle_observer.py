"""Slip angles of the axles, true or observed, and what they leave of a slip threshold."""

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation.plausible import Sensors
from ev_control.estimation.wheel_dynamics import WheelMotion
from ev_core.law import (
    Car,
    Choice,
    Wheels,
    atan,
    compilable,
    cos,
    entry,
    group,
    parameter,
    sin,
    sqrt,
)
from ev_msgs_py.contract.signals import DriverCommand

FRONT_WHEELS = 2  # places below it


class Correction(Choice):
    """Forms of the correction of slip thresholds by the slip angle."""

    NONE = auto()
    ELLIPSE = auto()


@dataclass(frozen=True, slots=True)
class SlipAngleObserverParameters:
    """Trust in the accelerometer against the linear tyre, and that tyre; all assumptions."""

    kinematic_share: float = parameter(
        0.9,
        unit="1",
        low=0.0,
        high=1.0,
        about="weight of the measured lateral acceleration against that of the linear tyre; the "
        "steady value is the tyre's alone unless it is 1, which drifts with every offset",
    )
    front_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the front axle"
    )
    rear_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the rear axle"
    )
    slowest: float = parameter(
        1.0, unit="m/s", low=0.1, high=10.0, about="speed at which slip angles are taken at least"
    )


@dataclass(slots=True)
class SlipAngleObserverState:
    """State of the slip-angle observer."""

    lateral_velocity: float = entry(
        unit="m/s", about="estimated lateral velocity of the centre of mass"
    )


class Turn(NamedTuple):
    """Motion of the car as the observer takes it."""

    speed: float  # along the car, negative in reverse [m/s]
    lateral_acceleration: float  # [m/s^2]
    yaw_rate: float  # [rad/s]
    road_wheel_angle: float  # mean of the front wheels [rad]


class SlipAngles(NamedTuple):
    """Slip angles d1, d2 of the axles [rad], positive on a circle to the left without drive."""

    front: float
    rear: float


@compilable
def axle_slip_angles(
    car: Car,
    longitudinal: float,
    lateral: float,
    yaw_rate: float,
    road_wheel_angle: float,
    slowest: float,
) -> SlipAngles:
    """Slip angles of both axles, with the signs of Zhileykin (2018), fig 1.

    d1 = delta - atan((v + a r)/u), d2 = -atan((v - b r)/u), from the velocities u, v of the centre
    of mass [m/s], the yaw rate r [rad/s] and the mean road-wheel angle delta [rad]; u is at least
    `slowest` [m/s]. In reverse, from there on, |u| stands for u and -delta for delta: tyres push
    against their way aside, wherever they roll.
    """
    delta = -road_wheel_angle if longitudinal <= -slowest else road_wheel_angle
    u, b = max(abs(longitudinal), slowest), car.centre_of_mass_to_rear_axle
    a = car.wheelbase - b
    return SlipAngles(
        delta - atan((lateral + a * yaw_rate) / u), -atan((lateral - b * yaw_rate) / u)
    )


@compilable
def observed_slip_angles(
    p: SlipAngleObserverParameters,
    car: Car,
    s: SlipAngleObserverState,
    period: float,
    driver: DriverCommand,
    sensors: Sensors,
) -> SlipAngles:
    """Estimate the slip angles of both axles from what the sensors of a car measure.

    The lateral velocity v follows v' = w a_y + (1 - w) a_tyre - r u, with the measured a_y and that
    of linear tyres, m a_tyre = C_1 (delta - (v + a r)/u) - C_2 (v - b r)/u: kinematics hold on
    every road but drift, the tyre does not drift but underrates the slip angles on a slippery road;
    w only sets how long the kinematics lead, because in a steady turn a_y = r u and the tyre alone
    decides. Implicit Euler, stable at every speed. The speed u is that of the slowest wheel,
    brought to the centre of mass, or of the fastest one under braking; negative in reverse, which
    is where the mean of the wheels is, and there the tyre reads as `axle_slip_angles` does. No
    source has it.
    """
    delta, r = sensors.column.road_wheel_angle, sensors.imu.yaw_rate
    speeds = rolling_speeds(car, s.lateral_velocity, sensors.wheels.velocity, delta, r)
    most = max(speeds[0], speeds[1], speeds[2], speeds[3])
    least = min(speeds[0], speeds[1], speeds[2], speeds[3])
    # By the mean of the wheels; a single one may spin or lock.
    reverses = (speeds[0] + speeds[1]) + (speeds[2] + speeds[3]) <= -4.0 * p.slowest
    braking = driver.brake_torque > 0.0 or (
        driver.drive_torque > 0.0 if reverses else driver.drive_torque < 0.0
    )
    # Speeds have a sign: of a car in reverse the least number is the fastest wheel.
    u = most if braking != reverses else least
    turn = Turn(u, sensors.imu.lateral_acceleration, r, delta)
    return slip_angles_at(p, car, s, period, turn, p.kinematic_share)


@compilable
def slip_angles_at(
    p: SlipAngleObserverParameters,
    car: Car,
    s: SlipAngleObserverState,
    period: float,
    turn: Turn,
    kinematic_share: float,
) -> SlipAngles:
    """Slip angles as `observed_slip_angles` has them, by a known speed and a weight w [1]."""
    w = kinematic_share
    r = turn.yaw_rate
    b = car.centre_of_mass_to_rear_axle
    ahead = -1.0 if turn.speed <= -p.slowest else 1.0
    u = max(abs(turn.speed), p.slowest)
    delta = ahead * turn.road_wheel_angle
    # Over the mass, so all below are accelerations; `at_rest` is the tyres' without lateral
    # velocity.
    front = p.front_cornering_stiffness / car.mass
    rear = p.rear_cornering_stiffness / car.mass
    at_rest = front * (delta - (car.wheelbase - b) * r / u) + rear * b * r / u
    # The part of the tyre force that depends on v is taken at the end of the step.
    damping = (1.0 - w) * (front + rear) / u
    believed = w * turn.lateral_acceleration + (1.0 - w) * at_rest
    s.lateral_velocity = (s.lateral_velocity + period * (believed - ahead * r * u)) / (
        1.0 + period * damping
    )
    return axle_slip_angles(car, ahead * u, s.lateral_velocity, r, turn.road_wheel_angle, p.slowest)


@compilable
def rolling_speeds(
    car: Car,
    lateral_velocity: float,
    wheel_velocity: Wheels,
    road_wheel_angle: float,
    yaw_rate: float,
) -> Wheels:
    """Speed of the car [m/s] that each wheel alone means, rolling without slip."""
    ahead = car.wheelbase - car.centre_of_mass_to_rear_axle
    along = cos(road_wheel_angle)
    across = (lateral_velocity + ahead * yaw_rate) * sin(road_wheel_angle)
    radius = car.wheel_radius
    front = car.front_track / 2.0 * yaw_rate
    rear = car.rear_track / 2.0 * yaw_rate
    return Wheels(
        (wheel_velocity.front_left * radius - across) / along + front,
        (wheel_velocity.front_right * radius - across) / along - front,
        wheel_velocity.rear_left * radius + rear,
        wheel_velocity.rear_right * radius - rear,
    )


@dataclass(frozen=True, slots=True)
class SideForceParameters:
    """Form of the correction; the source has it in the friction diagram, without a formula."""

    correction: Correction = parameter(
        Correction.NONE,
        about="of slip thresholds by the slip angle: none; or ellipse, S sqrt(1 - "
        "(alpha/alpha_max)^2)",
        source="dissertation, section 1.4, has no formula: the ellipse is an assumption",
    )
    largest_slip_angle: float = parameter(
        0.12,
        unit="rad",
        low=0.01,
        high=1.0,
        about="slip angle of the largest side force, alpha_max",
    )
    least: float = parameter(
        0.2, unit="1", low=0.0, high=1.0, about="share of a threshold that is always left"
    )
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)


@compilable
def slip_angle_of(
    p: SlipAngleObserverParameters,
    car: Car,
    s: SlipAngleObserverState,
    period: float,
    motion: WheelMotion,
) -> float:
    """Estimated slip angle of the wheel's axle [rad]; in reverse zero."""
    if motion.ahead < 0.0:
        return 0.0
    turn = Turn(
        motion.car_speed, motion.lateral_acceleration, motion.yaw_rate, motion.road_wheel_angle
    )
    angles = slip_angles_at(p, car, s, period, turn, p.kinematic_share)
    return angles.front if motion.place < FRONT_WHEELS else angles.rear


@compilable
def share_left(
    p: SideForceParameters, car: Car, s: SlipAngleObserverState, period: float, motion: WheelMotion
) -> float:
    """Share that is left of a slip threshold [1]: sqrt(1 - (alpha/alpha_max)^2), or `least`.

    Without correction all of it is left.
    """
    if p.correction == Correction.NONE:
        return 1.0
    use = slip_angle_of(p.observer, car, s, period, motion) / p.largest_slip_angle
    return max(sqrt(max(1.0 - use * use, 0.0)), p.least)
