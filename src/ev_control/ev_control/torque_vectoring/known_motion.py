"""What yaw moment control knows of the car: all of it, or what sensors of a car and their estimators give."""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.friction_estimate import (
    FrictionEstimateParameters,
    FrictionEstimateState,
    estimated_friction,
    unknown_road,
)
from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    slip_angles_at,
)
from ev_control.estimation.wheel_dynamics import wheel_loads
from ev_control.shared.torque_split import TRUTH
from ev_control.torque_vectoring.lateral_friction import (
    LateralFrictionParameters,
    LateralFrictionState,
    lateral_friction,
)
from ev_core.law import Car, Wheels, compilable, group, isfinite, parameter, part
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
)


@dataclass(frozen=True, slots=True)
class KnownMotionParameters:
    """How wrong the friction is that the law believes in, and the estimators of what no sensor measures."""

    error_factor: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="friction that the law believes in over that it knows"
    )
    friction: FrictionEstimateParameters = group(FrictionEstimateParameters)
    lateral: LateralFrictionParameters = group(LateralFrictionParameters)
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    sliding_kinematic_share: float = parameter(
        0.98, unit="1", low=0.0, high=1.0, about="weight in the place of observer.kinematic_share while an axle slides",
        source="after Fukada (1999), Slip-angle estimation for vehicle stability control, VSD 32; value: assumption",
    )  # fmt: skip


@dataclass(slots=True)
class KnownMotionState:
    """What lasts between steps."""

    friction: FrictionEstimateState = part(FrictionEstimateState)
    lateral: LateralFrictionState = part(LateralFrictionState)
    observer: SlipAngleObserverState = part(SlipAngleObserverState)


def unknown_motion(p: KnownMotionParameters) -> KnownMotionState:
    """The state that believes in the largest friction."""
    return KnownMotionState(unknown_road(p.friction), LateralFrictionState(p.friction.largest_friction))


class KnownMotion(NamedTuple):
    """The motion of the centre of mass, and the grip of the wheels."""

    speed: float  # along the car, negative in reverse [m/s]
    lateral: float  # [m/s]
    yaw_rate: float  # [rad/s]
    grip: Wheels  # friction times load [N]
    side_force: Wheels  # [N]


FASTEST = 1e3  # [m/s]; beyond it no number is the speed of a road vehicle


@compilable
def is_known(
    source: str,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    body: BodyVelocity,
    tires: TireForces,
) -> bool:
    """Whether what the law goes by is finite and could be a road vehicle's."""  # fmt: skip
    if source != TRUTH:
        return is_plausible(column, wheels, imu)
    friction, load, side = tires.friction_coefficient, tires.load, tires.lateral_force
    sums = (friction[0] + friction[1]) + (friction[2] + friction[3]) + (load[0] + load[1]) + (load[2] + load[3])
    return (
        is_plausible(column, wheels, imu)
        and abs(body.longitudinal) + abs(body.lateral) < FASTEST
        and isfinite(body.yaw_rate)
        and isfinite(sums + ((side[0] + side[1]) + (side[2] + side[3])))
    )


@compilable
def known_motion(
    p: KnownMotionParameters,
    car: Car,
    s: KnownMotionState,
    period: float,
    source: str,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    body: BodyVelocity,
    tires: TireForces,
) -> KnownMotion:
    """The motion as it is, or by wheel speeds, accelerations, yaw rate and steering angle.

    Estimated are the speed by `reference_speed`, the lateral velocity by `slip_angle_observer`, and the friction of
    wheels that slip by `friction_estimate`, or by `lateral_friction` where that is less. Loads follow from the
    accelerations, and side forces share m a_y as loads do.
    """
    if source == TRUTH:
        friction, load, side = tires.friction_coefficient, tires.load, tires.lateral_force
        return KnownMotion(
            body.longitudinal, body.lateral, body.yaw_rate, grip_of(p.error_factor, friction, load), side
        )
    load = wheel_loads(car, imu)
    friction = estimated_friction(p.friction, car, s.friction, period, driver.drive_torque, load, column, wheels, imu)
    speed, a_y = s.friction.reference.speed, imu.lateral_acceleration
    # The linear tyre of the observer knows nothing of an axle that slides.
    trust = p.sliding_kinematic_share if s.lateral.slides == 1.0 else p.observer.kinematic_share
    slides = slip_angles_at(
        p.observer, car, s.observer, period, trust, speed, a_y, imu.yaw_rate, column.road_wheel_angle
    )
    aside = lateral_friction(
        p.lateral, p.friction, p.observer, car, s.lateral, period, driver.brake_torque, speed, slides, load, wheels, imu
    )
    friction = Wheels(
        min(friction[0], aside), min(friction[1], aside), min(friction[2], aside), min(friction[3], aside)
    )
    share = car.mass * a_y / ((load[0] + load[1]) + (load[2] + load[3]))
    side = Wheels(share * load[0], share * load[1], share * load[2], share * load[3])
    grip = grip_of(p.error_factor, friction, load)
    return KnownMotion(speed, s.observer.lateral_velocity, imu.yaw_rate, grip, side)


@compilable
def grip_of(factor: float, friction: Wheels, load: Wheels) -> Wheels:
    """Believed friction times load [N]."""
    return Wheels(
        factor * friction[0] * load[0],
        factor * friction[1] * load[1],
        factor * friction[2] * load[2],
        factor * friction[3] * load[3],
    )
