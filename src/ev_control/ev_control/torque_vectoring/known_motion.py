"""Motion of the car as yaw moment control knows it: all of it, or by sensors and estimators."""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.friction_estimate import (
    FrictionEstimateParameters,
    FrictionEstimateState,
    estimated_friction,
    unknown_road,
)
from ev_control.estimation.plausible import Sensors, is_plausible
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    Turn,
    slip_angles_at,
)
from ev_control.estimation.wheel_dynamics import wheel_loads
from ev_control.shared.torque_split import KnownBy
from ev_control.torque_vectoring.lateral_friction import (
    Beliefs,
    LateralFrictionParameters,
    LateralFrictionState,
    Slide,
    lateral_friction,
)
from ev_core.law import Car, Wheels, compilable, group, isfinite, parameter, part
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    TireForces,
)

FASTEST = 1e3  # [m/s]; beyond it no number is the speed of a road vehicle


@dataclass(frozen=True, slots=True)
class KnownMotionParameters:
    """Error of the friction, and estimators of what no sensor measures."""

    error_factor: float = parameter(
        1.0,
        unit="1",
        low=0.1,
        high=10.0,
        about="friction that the law believes in over that it knows",
    )
    friction: FrictionEstimateParameters = group(FrictionEstimateParameters)
    lateral: LateralFrictionParameters = group(LateralFrictionParameters)
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    sliding_kinematic_share: float = parameter(
        0.98,
        unit="1",
        low=0.0,
        high=1.0,
        about="weight in the place of observer.kinematic_share while an axle slides",
        source="after Fukada (1999), Slip-angle estimation for vehicle stability control, VSD 32; "
        "value: assumption",
    )


@dataclass(slots=True)
class KnownMotionState:
    """State of the estimators."""

    friction: FrictionEstimateState = part(FrictionEstimateState)
    lateral: LateralFrictionState = part(LateralFrictionState)
    observer: SlipAngleObserverState = part(SlipAngleObserverState)


def unknown_motion(p: KnownMotionParameters) -> KnownMotionState:
    """The state that believes in the largest friction."""
    return KnownMotionState(
        unknown_road(p.friction), LateralFrictionState(p.friction.largest_friction)
    )


class CarSeen(NamedTuple):
    """Signals that yaw moment control reads."""

    driver: DriverCommand
    sensors: Sensors
    body: BodyVelocity
    tires: TireForces


class KnownMotion(NamedTuple):
    """Motion of the centre of mass, grip of the wheels, and what is measured besides."""

    speed: float  # along the car, negative in reverse [m/s]
    lateral: float  # [m/s]
    yaw_rate: float  # [rad/s]
    grip: Wheels  # friction times load [N]
    side_force: Wheels  # [N]
    road_wheel_angle: float  # mean of the front wheels [rad]
    wheel_speed: Wheels  # [rad/s]
    imu: InertialMeasurement


@compilable
def is_known(source: KnownBy, seen: CarSeen) -> bool:
    """Return true if what the law goes by is finite and could be a road vehicle's."""
    if source != KnownBy.TRUTH:
        return is_plausible(seen.sensors)
    body, tires = seen.body, seen.tires
    friction = tires.friction_coefficient
    load = tires.load
    side = tires.lateral_force
    sums = (friction[0] + friction[1]) + (friction[2] + friction[3])
    sums = sums + (load[0] + load[1]) + (load[2] + load[3])
    return (
        is_plausible(seen.sensors)
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
    source: KnownBy,
    seen: CarSeen,
) -> KnownMotion:
    """Motion as it is, or by wheel speeds, accelerations, yaw rate and steering angle."""
    if source == KnownBy.TRUTH:
        return true_motion(p, seen)
    return estimated_motion(p, car, s, period, seen)


@compilable
def true_motion(p: KnownMotionParameters, seen: CarSeen) -> KnownMotion:
    """Motion as the plant has it."""
    body = seen.body
    tires = seen.tires
    sensors = seen.sensors
    return KnownMotion(
        body.longitudinal,
        body.lateral,
        body.yaw_rate,
        grip_of(p.error_factor, tires.friction_coefficient, tires.load),
        tires.lateral_force,
        sensors.column.road_wheel_angle,
        sensors.wheels.velocity,
        sensors.imu,
    )


@compilable
def estimated_motion(
    p: KnownMotionParameters, car: Car, s: KnownMotionState, period: float, seen: CarSeen
) -> KnownMotion:
    """Motion by the sensors of a car.

    Estimated are the speed by `reference_speed`, the lateral velocity by `slip_angle_observer`, and
    the friction of wheels that slip by `friction_estimate`, or by `lateral_friction` where that is
    less. Loads follow from the accelerations, and side forces share m a_y as loads do.
    """
    driver = seen.driver
    sensors = seen.sensors
    imu = seen.sensors.imu
    load, a_y = wheel_loads(car, imu), imu.lateral_acceleration
    by_slip = estimated_friction(p.friction, car, s.friction, period, driver.drive_torque, sensors)
    speed = s.friction.reference.speed
    # The linear tyre of the observer knows nothing of an axle that slides.
    trust = p.sliding_kinematic_share if s.lateral.slides else p.observer.kinematic_share
    turn = Turn(speed, a_y, imu.yaw_rate, sensors.column.road_wheel_angle)
    slides = slip_angles_at(p.observer, car, s.observer, period, turn, trust)
    beliefs = Beliefs(p.lateral, p.friction, p.observer)
    slide = Slide(driver.brake_torque, speed, slides, load, sensors)
    aside = lateral_friction(beliefs, car, s.lateral, period, slide)
    friction = Wheels(
        min(by_slip[0], aside),
        min(by_slip[1], aside),
        min(by_slip[2], aside),
        min(by_slip[3], aside),
    )
    share = car.mass * a_y / ((load[0] + load[1]) + (load[2] + load[3]))
    side = Wheels(share * load[0], share * load[1], share * load[2], share * load[3])
    return KnownMotion(
        speed,
        s.observer.lateral_velocity,
        imu.yaw_rate,
        grip_of(p.error_factor, friction, load),
        side,
        sensors.column.road_wheel_angle,
        sensors.wheels.velocity,
        imu,
    )


@compilable
def grip_of(factor: float, friction: Wheels, load: Wheels) -> Wheels:
    """Believed friction times load [N]."""
    return Wheels(
        factor * friction[0] * load[0],
        factor * friction[1] * load[1],
        factor * friction[2] * load[2],
        factor * friction[3] * load[3],
    )
