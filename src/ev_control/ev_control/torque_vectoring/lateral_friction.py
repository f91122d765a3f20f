"""Friction of the road, learnt from the side forces of an axle that slides aside.

m a_y = F_1 + F_2 and J r' = a F_1 - b F_2 + M_z give the side force of each axle, whatever its
tyres are. It is held against that of a linear tyre, C alpha, at the estimated slip angle. By the
brush model (Fiala 1954; for an estimate of friction Hsu, Laws & Gerdes 2010, Estimation of tire
slip angle and friction limits using steering torque, IEEE Trans. Control Systems Technology 18(4)),
with x = C tan(alpha)/(3 mu F_z),

    F/(C tan(alpha)) = 1 - x + x^2/3,    F/(mu F_z) = 1 - (1 - x)^3,

an axle with half the force of the linear tyre uses 0.95 of its friction: what it uses is then taken
for the road's.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.friction_estimate import FrictionLearningParameters, learnt_friction
from ev_control.estimation.plausible import Sensors
from ev_control.estimation.slip_angle_observer import SlipAngleObserverParameters, SlipAngles
from ev_control.estimation.wheel_dynamics import filter_share
from ev_control.torque_vectoring.shares import turned_by
from ev_core.law import (
    Car,
    Wheels,
    compilable,
    copysign,
    entry,
    parameter,
    part,
    sqrt,
)


@dataclass(frozen=True, slots=True)
class LateralFrictionParameters:
    """Limits beyond which an axle counts as sliding aside."""

    force_share: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=0.9,
        about="side force over that of the linear tyre, below which an axle slides",
        source="assumption: a cornering stiffness that is a quarter off does no harm",
    )
    least_slip_angle: float = parameter(
        0.02,
        unit="rad",
        low=1e-3,
        high=1.0,
        about="slip angle below which no axle slides: noise and offsets",
    )
    filter_time: float = parameter(
        0.05, unit="s", low=0.0, high=1.0, about="time constant of all forces"
    )
    hold_time: float = parameter(
        0.1,
        unit="s",
        low=0.0,
        high=1.0,
        about="further time constant, after which the linear tyre still has its force",
    )
    slowest: float = parameter(
        5.0, unit="m/s", low=0.1, high=100.0, about="speed below which nothing is learnt"
    )


@dataclass(slots=True)
class AxleForces:
    """Filtered forces of an axle."""

    side: float = entry(unit="N", about="side force")
    along: float = entry(unit="N", about="force of the drives")
    linear: float = entry(unit="N", about="side force of the linear tyre")
    held: float = entry(unit="N", about="the same, filtered once more")


@dataclass(slots=True)
class LateralFrictionState:
    """State of both axles."""

    friction: float = entry(unit="1", about="estimated friction of the road")
    slides: bool = entry(False, unit="1", about="whether an axle slides")
    front: AxleForces = part(AxleForces)
    rear: AxleForces = part(AxleForces)
    yaw_rate: float = entry(unit="rad/s", about="of the step before")
    known: bool = entry(False, unit="1", about="whether there was a step before")


class Beliefs(NamedTuple):
    """Parameters of the estimate, of what it learns, and of the linear tyres."""

    sliding: LateralFrictionParameters
    learning: FrictionLearningParameters
    tyres: SlipAngleObserverParameters


class Slide(NamedTuple):
    """Motion of the car in a step."""

    brake_torque: float  # of the driver [N m]
    speed: float  # along the car [m/s]
    slip_angles: SlipAngles
    load: Wheels  # [N]
    sensors: Sensors


class AxleSlide(NamedTuple):
    """Motion of an axle in a step."""

    stiffness: float  # cornering stiffness [N/rad]
    slip_angle: float  # [rad]
    speed: float  # of the car [m/s]
    side: float  # side force [N]


@compilable
def lateral_friction(
    p: Beliefs, car: Car, s: LateralFrictionState, period: float, now: Slide
) -> float:
    """Friction of the road [1], the same under both axles.

    While an axle slides it is sqrt(F_x^2 + F_y^2)/F_z, of the axle that uses more; else a value
    that slowly rises (`learnt_friction`), and at least what an axle uses. While the driver brakes,
    a force that is not measured, nothing is learnt.
    """
    effort, imu = now.sensors.wheels.effort, now.sensors.imu
    speed, load = now.speed, now.load
    # Yaw acceleration; without a step before it is taken as zero.
    turn = (imu.yaw_rate - s.yaw_rate) / period if s.known else 0.0
    s.yaw_rate = imu.yaw_rate
    s.known = True
    # Both balances, of force and of moment, solved for the side force of each axle.
    rear_arm = car.centre_of_mass_to_rear_axle
    front_arm = car.wheelbase - car.centre_of_mass_to_rear_axle
    across = car.mass * imu.lateral_acceleration
    by_tyres = car.yaw_inertia * turn - turned_by(car, effort)
    front_side = (across * rear_arm + by_tyres) / car.wheelbase
    rear_side = (across * front_arm - by_tyres) / car.wheelbase
    front_stiffness = p.tyres.front_cornering_stiffness
    rear_stiffness = p.tyres.rear_cornering_stiffness
    front = AxleSlide(front_stiffness, now.slip_angles.front, speed, front_side)
    rear = AxleSlide(rear_stiffness, now.slip_angles.rear, speed, rear_side)
    follow_forces(p.sliding, car, s.front, period, front)
    follow_forces(p.sliding, car, s.rear, period, rear)
    # Wheels that spin up take torque that the road does not carry: no axle pushes more than the car
    # is accelerated.
    share, radius = filter_share(period, p.sliding.filter_time), car.wheel_radius
    most = car.mass * abs(imu.longitudinal_acceleration)
    front_push = min(max((effort[0] + effort[1]) / radius, -most), most)
    rear_push = min(max((effort[2] + effort[3]) / radius, -most), most)
    s.front.along += share * (front_push - s.front.along)
    s.rear.along += share * (rear_push - s.rear.along)
    front_slides = slides_aside(p.sliding, s.front, front_stiffness)
    rear_slides = slides_aside(p.sliding, s.rear, rear_stiffness)
    s.slides = (rear_slides or front_slides) and abs(speed) >= p.sliding.slowest
    if abs(speed) >= p.sliding.slowest and now.brake_torque == 0.0:
        front_use = friction_in_use(s.front, load[0] + load[1])
        rear_use = friction_in_use(s.rear, load[2] + load[3])
        used = max(front_use, rear_use)
        learnt = learnt_friction(p.learning, s.friction, used, s.slides, period)
        s.friction = max(learnt, min(used, p.learning.largest_friction))
    return s.friction


@compilable
def follow_forces(
    p: LateralFrictionParameters, car: Car, s: AxleForces, period: float, now: AxleSlide
) -> None:
    """Filter the side force of an axle and that of its linear tyre.

    The tyre takes a way C/(2 k) to build its force up [m].
    """
    s.side += filter_share(period, p.filter_time) * (now.side - s.side)
    speed = max(abs(now.speed), p.slowest)
    relaxation = now.stiffness / (2.0 * car.tyre.lateral_stiffness * speed)
    share = filter_share(period, p.filter_time + relaxation)
    s.linear += share * (now.stiffness * now.slip_angle - s.linear)
    s.held += filter_share(period, p.hold_time) * (s.linear - s.held)


@compilable
def slides_aside(p: LateralFrictionParameters, s: AxleForces, stiffness: float) -> bool:
    """Return true if an axle has had much less side force than its linear tyre for a while.

    Where side forces change their sign, a small error of the slip angle is any share of them.
    """
    # The linear force has just changed its sign: its share means nothing.
    if s.linear * s.held <= 0.0:
        return False
    # The smaller one, so that a force that builds up does not count as missing.
    linear = copysign(min(abs(s.linear), abs(s.held)), s.linear)
    bends = abs(linear) > stiffness * p.least_slip_angle
    return bends and 0.0 <= s.side * linear < p.force_share * linear * linear


@compilable
def friction_in_use(s: AxleForces, load: float) -> float:
    """Resultant of the forces of an axle over its load [1]."""
    return sqrt(s.side * s.side + s.along * s.along) / load
