"""Friction of the road, learnt while an axle slides aside, from the side forces that accelerations and yaw rate show.

m a_y = F_1 + F_2 and J r' = a F_1 - b F_2 + M_z give the side force of each axle, whatever its tyres are. It is held
against that of a linear tyre, C alpha, at the estimated slip angle. By the brush model (Fiala 1954; for an estimate of
friction Hsu, Laws & Gerdes 2010, Estimation of tire slip angle and friction limits using steering torque, IEEE Trans.
Control Systems Technology 18(4)), with x = C tan(alpha)/(3 mu F_z),

    F/(C tan(alpha)) = 1 - x + x^2/3,    F/(mu F_z) = 1 - (1 - x)^3,

an axle with half the force of the linear tyre uses 0.95 of its friction: what it uses is then taken for the road's.
"""

from dataclasses import dataclass

from ev_control.estimation.friction_estimate import FrictionLearningParameters, learnt_friction
from ev_control.estimation.slip_angle_observer import SlipAngleObserverParameters, SlipAngles
from ev_control.estimation.wheel_dynamics import filter_share
from ev_control.torque_vectoring.shares import turned_by
from ev_core.law import (
    Car,
    InertialMeasurement,
    Wheels,
    WheelStates,
    compilable,
    copysign,
    entry,
    parameter,
    part,
    sqrt,
)


@dataclass(frozen=True, slots=True)
class LateralFrictionParameters:
    """When an axle counts as sliding aside."""

    force_share: float = parameter(
        0.5, unit="1", low=0.0, high=0.9,
        about="side force over that of the linear tyre, below which an axle slides",
        source="assumption: a cornering stiffness that is a quarter off does no harm",
    )  # fmt: skip
    least_slip_angle: float = parameter(
        0.02, unit="rad", low=1e-3, high=1.0, about="slip angle below which no axle slides: noise and offsets"
    )
    filter_time: float = parameter(0.05, unit="s", low=0.0, high=1.0, about="time constant of all forces")
    hold_time: float = parameter(
        0.1, unit="s", low=0.0, high=1.0, about="further time constant, after which the linear tyre still has its force"
    )
    slowest: float = parameter(5.0, unit="m/s", low=0.1, high=100.0, about="speed below which nothing is learnt")


@dataclass(slots=True)
class AxleForces:
    """Filtered forces of an axle."""

    side: float = entry(unit="N", about="side force")
    along: float = entry(unit="N", about="force of the drives")
    linear: float = entry(unit="N", about="side force of the linear tyre")
    held: float = entry(unit="N", about="the same, filtered once more")


@dataclass(slots=True)
class LateralFrictionState:
    """What lasts between steps."""

    friction: float = entry(unit="1", about="estimated friction of the road")
    slides: float = entry(unit="1", about="whether an axle slides")
    front: AxleForces = part(AxleForces)
    rear: AxleForces = part(AxleForces)
    yaw_rate: float = entry(unit="rad/s", about="of the step before")
    known: float = entry(unit="1", about="whether there was a step before")


@compilable
def lateral_friction(
    p: LateralFrictionParameters,
    learning: FrictionLearningParameters,
    tyres: SlipAngleObserverParameters,
    car: Car,
    s: LateralFrictionState,
    period: float,
    brake_torque: float,
    speed: float,
    slip_angles: SlipAngles,
    load: Wheels,
    wheels: WheelStates,
    imu: InertialMeasurement,
) -> float:
    """The friction of the road [1], the same under both axles, at a speed of the car [m/s] and loads [N].

    While an axle slides it is sqrt(F_x^2 + F_y^2)/F_z, of the axle that uses more; else a value that slowly rises
    (`learnt_friction`), and at least what an axle uses. While the driver brakes, a force that is not measured, nothing
    is learnt.
    """
    turn = (imu.yaw_rate - s.yaw_rate) / period if s.known == 1.0 else 0.0
    s.yaw_rate, s.known = imu.yaw_rate, 1.0
    rear_arm, effort, radius = car.centre_of_mass_to_rear_axle, wheels.effort, car.wheel_radius
    across, by_tyres = car.mass * imu.lateral_acceleration, car.yaw_inertia * turn - turned_by(car, effort)
    side = (across * rear_arm + by_tyres) / car.wheelbase
    follow_forces(p, car, s.front, period, tyres.front_cornering_stiffness, slip_angles.front, speed, side)
    side = (across * (car.wheelbase - rear_arm) - by_tyres) / car.wheelbase
    follow_forces(p, car, s.rear, period, tyres.rear_cornering_stiffness, slip_angles.rear, speed, side)
    # Wheels that spin up take torque that the road does not carry: no axle pushes more than the car is accelerated.
    share, most = filter_share(period, p.filter_time), car.mass * abs(imu.longitudinal_acceleration)
    s.front.along += share * (min(max((effort[0] + effort[1]) / radius, -most), most) - s.front.along)
    s.rear.along += share * (min(max((effort[2] + effort[3]) / radius, -most), most) - s.rear.along)
    slides = slides_aside(p, s.front, tyres.front_cornering_stiffness)
    slides = (slides_aside(p, s.rear, tyres.rear_cornering_stiffness) or slides) and abs(speed) >= p.slowest
    s.slides = 1.0 if slides else 0.0
    if abs(speed) >= p.slowest and brake_torque == 0.0:
        used = max(friction_in_use(s.front, load[0] + load[1]), friction_in_use(s.rear, load[2] + load[3]))
        learnt = learnt_friction(learning, s.friction, used, slides, period)
        s.friction = max(learnt, min(used, learning.largest_friction))
    return s.friction


@compilable
def follow_forces(
    p: LateralFrictionParameters,
    car: Car,
    s: AxleForces,
    period: float,
    stiffness: float,
    slip_angle: float,
    speed: float,
    side: float,
) -> None:
    """Filter the side force of an axle [N] and that of its linear tyre, which takes a way C/(2 k) to build up [m]."""
    s.side += filter_share(period, p.filter_time) * (side - s.side)
    relaxation = stiffness / (2.0 * car.tyre.lateral_stiffness * max(abs(speed), p.slowest))
    s.linear += filter_share(period, p.filter_time + relaxation) * (stiffness * slip_angle - s.linear)
    s.held += filter_share(period, p.hold_time) * (s.linear - s.held)


@compilable
def slides_aside(p: LateralFrictionParameters, s: AxleForces, stiffness: float) -> bool:
    """Whether an axle has much less side force than its linear tyre, and has had so for a while.

    Where side forces change their sign, a small error of the slip angle is any share of them.
    """
    if s.linear * s.held <= 0.0:
        return False
    linear = copysign(min(abs(s.linear), abs(s.held)), s.linear)
    bends = abs(linear) > stiffness * p.least_slip_angle
    return bends and 0.0 <= s.side * linear < p.force_share * linear * linear


@compilable
def friction_in_use(s: AxleForces, load: float) -> float:
    """Resultant of the forces of an axle over its load [1]."""
    return sqrt(s.side * s.side + s.along * s.along) / load
