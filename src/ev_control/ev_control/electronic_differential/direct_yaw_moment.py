"""Yaw moment control in exchangeable parts: reference, controller, allocation, and what it knows of the car."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, split, split_brake
from ev_control.shared.torque_split import KNOWN_BY, differential
from ev_control.torque_vectoring.integral import MomentIntegral, follow_saturation
from ev_control.torque_vectoring.known_motion import (
    KnownMotion,
    KnownMotionParameters,
    KnownMotionState,
    is_known,
    known_motion,
    unknown_motion,
)
from ev_control.torque_vectoring.least_loss import least_loss
from ev_control.torque_vectoring.lqr import NO_GAINS, Gains, LQRParameters, lqr_gains, lqr_moment
from ev_control.torque_vectoring.pi import PIParameters, pi_moment
from ev_control.torque_vectoring.predictive import predictive_moment
from ev_control.torque_vectoring.reference import (
    REFERENCES,
    ReferenceParameters,
    ReferenceState,
    wanted_motion,
)
from ev_control.torque_vectoring.shares import (
    ShareParameters,
    an_axle_with_motors,
    by_axle,
    by_load,
    motors_turn,
    turned_by,
)
from ev_control.torque_vectoring.single_track import (
    SingleTrackParameters,
    single_track,
    steady_lateral_velocity,
    steady_moment,
)
from ev_control.torque_vectoring.sliding_modes import (
    SlidingModeParameters,
    SuboptimalParameters,
    SuboptimalState,
    SuperTwistingParameters,
    forget_extrema,
    sliding_mode_moment,
    suboptimal_moment,
    super_twisting_moment,
)
from ev_control.torque_vectoring.weighted_least_squares import LeastSquaresParameters, least_squares
from ev_core.law import BodyVelocity, Car, DriverCommand, Vehicle, Wheels, compilable, group, parameter, part
from ev_core.vehicle.losses import NO_MAP, EfficiencyMap, efficiency_map
from ev_msgs_py.contract.signals import (
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)

CONTROLLERS = ("pi", "lqr", "predictive", "sliding_mode", "super_twisting", "suboptimal")
PI, LQR, PREDICTIVE, SLIDING_MODE, SUPER_TWISTING, SUBOPTIMAL = range(len(CONTROLLERS))
ALLOCATIONS = ("axle", "load", "least_squares", "least_loss")
BY_AXLE, BY_LOAD, LEAST_SQUARES, LEAST_LOSS = range(len(ALLOCATIONS))


@dataclass(frozen=True, slots=True)
class DirectYawMomentParameters:
    """Which parts are combined, and the parameters of each."""

    reference: str = parameter(
        "understeer",
        choices=REFERENCES,
        about="wanted yaw rate: of a neutral car; of a designed understeer; or that with less where the rear slides",
    )
    controller: str = parameter("pi", choices=CONTROLLERS, about="what makes the yaw moment of the errors")
    allocation: str = parameter(
        "axle",
        choices=ALLOCATIONS,
        about="torques: equal, and a fixed share of the moment on each axle; both as loads are; with the least use of "
        "grip within motors and tyres; or with the least loss of motors and inverters within them",
    )
    estimation: str = parameter(
        "truth", choices=KNOWN_BY, about="motion and friction: as the plant has them, or by sensors of a car alone"
    )
    feed_forward: float = parameter(
        1.0, unit="1", low=0.0, high=2.0, about="share of the moment that the linear car needs for the wanted yaw rate"
    )
    largest_moment: float = parameter(
        6000.0, unit="N m", low=0.0, high=1e6, about="yaw moment that is asked for at most"
    )
    tracking_time: float = parameter(
        0.1, unit="s", low=0.001, high=10.0, about="time in which integrals follow a moment that saturates"
    )
    single_track: SingleTrackParameters = group(SingleTrackParameters)
    wanted: ReferenceParameters = group(ReferenceParameters)
    known: KnownMotionParameters = group(KnownMotionParameters)
    pi: PIParameters = group(PIParameters)
    lqr: LQRParameters = group(LQRParameters)
    sliding_mode: SlidingModeParameters = group(SlidingModeParameters)
    super_twisting: SuperTwistingParameters = group(SuperTwistingParameters)
    suboptimal: SuboptimalParameters = group(SuboptimalParameters)
    axle: ShareParameters = group(ShareParameters)
    least_squares: LeastSquaresParameters = group(LeastSquaresParameters)
    limits: AllocationParameters = group(AllocationParameters, keep="difference")
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class DirectYawMomentState:
    """What lasts between steps."""

    integral: MomentIntegral = part(MomentIntegral)
    suboptimal: SuboptimalState = part(SuboptimalState)
    wanted: ReferenceState = part(ReferenceState)
    known: KnownMotionState = part(KnownMotionState)


class DirectYawMomentConstants(NamedTuple):
    """What follows from parameters and vehicle alone."""

    gains: Gains
    map: EfficiencyMap


def prepare(parameters: DirectYawMomentParameters, vehicle: Vehicle, period: float) -> DirectYawMomentConstants:
    """The gains of the regulator by speed and the map of the motors, where they are asked for."""
    asked = parameters.controller in ("lqr", "predictive")
    gains = lqr_gains(parameters.lqr, parameters.single_track, vehicle, period) if asked else NO_GAINS
    table = efficiency_map(vehicle.motor) if parameters.allocation == "least_loss" else NO_MAP
    return DirectYawMomentConstants(gains, table)


@differential(
    "direct_yaw_moment",
    start=lambda p: DirectYawMomentState(known=unknown_motion(p.known)),
    prepare=prepare,
    needs=(an_axle_with_motors,),
)
@compilable
def direct_yaw_moment(
    p: DirectYawMomentParameters,
    car: Car,
    c: DirectYawMomentConstants,
    s: DirectYawMomentState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    body: BodyVelocity,
    tires: TireForces,
) -> WheelTorqueRequest:
    """Turn the car as the driver is taken to want by different torques left and right, which add up to the driver's.

    M_z = f (M_ff + J r*') + feedback(r - r*, v - v*), within +-`largest_moment`, whole from twice `slowest` on.
    M_ff holds the linear single-track car at the wanted yaw rate r*; v* is the lateral velocity that belongs to it.
    `ev_control.torque_vectoring` has each part with its source. Integrals follow what the allocation leaves of the
    moment. Where a measurement is absurd, all driven wheels get the same torque. Left positive.
    """
    if not is_known(p.estimation, column, wheels, imu, body, tires):
        return split(p.brake, car, driver, 0.0)
    motion = known_motion(p.known, car, s.known, period, p.estimation, driver, column, wheels, imu, body, tires)
    asked, fast = 0.0, faded_in(p.single_track, motion.speed)
    if fast == 0.0:
        s.wanted.yaw_rate = 0.0
    else:
        angle, a_y = column.road_wheel_angle, imu.lateral_acceleration
        asked = fast * wanted_moment(p, car, c.gains, s, period, motion, wheels, angle, a_y)
        asked = min(max(asked, -p.largest_moment), p.largest_moment)
    drive = torques(p, car, c.map, motion, wheels, imu, driver.drive_torque, asked)
    request = allocated(p.limits, car, wheels, WheelTorqueRequest(drive, split_brake(p.brake, driver)))
    if fast > 0.0 and (p.controller == PI or p.controller == SUPER_TWISTING or p.controller == SUBOPTIMAL):
        # By load, left and right differ without a moment: only what saturation takes is missing.
        given = turned_by(car, drive) if p.allocation == BY_AXLE or p.allocation == BY_LOAD else asked
        follow_saturation(s.integral, period, p.tracking_time, given - turned_by(car, request.drive))
    else:
        s.integral.moment = 0.0
    if fast == 0.0 or p.controller != SUBOPTIMAL:
        forget_extrema(s.suboptimal)
    return request


@compilable
def faded_in(p: SingleTrackParameters, speed: float) -> float:
    """The share of the moment at a speed [m/s]: none up to `slowest`, all from twice of it on [1]."""
    return min(max(abs(speed) / p.slowest - 1.0, 0.0), 1.0)


@compilable
def wanted_moment(
    p: DirectYawMomentParameters,
    car: Car,
    c: Gains,
    s: DirectYawMomentState,
    period: float,
    motion: KnownMotion,
    wheels: WheelStates,
    road_wheel_angle: float,
    lateral_acceleration: float,
) -> float:
    """The yaw moment [N m] that brings the car to the wanted motion and keeps it there."""
    u, r = motion.speed, motion.yaw_rate
    grip = ((motion.grip[0] + motion.grip[1]) + (motion.grip[2] + motion.grip[3])) / car.mass
    behind = -(motion.lateral - car.centre_of_mass_to_rear_axle * r) / abs(u)
    wanted = wanted_motion(
        p.wanted, car, s.wanted, period, p.reference, u, road_wheel_angle, grip, lateral_acceleration, behind
    )
    model = single_track(p.single_track, car, u)
    sliding = motion.lateral - steady_lateral_velocity(model, wanted.angle, wanted.yaw_rate)
    ahead = steady_moment(car, model, wanted.angle, wanted.yaw_rate) + car.yaw_inertia * wanted.rate
    ahead, turning = p.feed_forward * ahead, r - wanted.yaw_rate
    if p.controller != PREDICTIVE:
        return ahead + feedback(p, car, c, s, period, u, sliding, turning)
    most, slowest = min(p.largest_moment, motors_turn(car, wheels.velocity)), p.single_track.slowest
    return ahead + predictive_moment(p.lqr, car, c, model, period, u, slowest, sliding, turning, ahead, most)


@compilable
def feedback(
    p: DirectYawMomentParameters,
    car: Car,
    c: Gains,
    s: DirectYawMomentState,
    period: float,
    speed: float,
    lateral_error: float,
    yaw_error: float,
) -> float:
    """The moment of the chosen controller [N m], by the errors of lateral velocity [m/s] and yaw rate [rad/s]."""
    if p.controller == PI:
        return pi_moment(p.pi, car, s.integral, period, yaw_error)
    if p.controller == LQR:
        return lqr_moment(c, speed, lateral_error, yaw_error)
    if p.controller == SLIDING_MODE:
        return sliding_mode_moment(p.sliding_mode, car, yaw_error)
    if p.controller == SUBOPTIMAL:
        return suboptimal_moment(p.suboptimal, car, s.suboptimal, s.integral, period, yaw_error)
    return super_twisting_moment(p.super_twisting, car, s.integral, period, yaw_error)


@compilable
def torques(
    p: DirectYawMomentParameters,
    car: Car,
    table: EfficiencyMap,
    motion: KnownMotion,
    wheels: WheelStates,
    imu: InertialMeasurement,
    total: float,
    moment: float,
) -> Wheels:
    """Drive torques by the chosen allocation [N m]."""
    if p.allocation == BY_AXLE:
        return by_axle(p.axle, car, total, moment)
    if p.allocation == BY_LOAD:
        return by_load(car, imu, total, moment)
    if p.allocation == LEAST_LOSS:
        return least_loss(p.least_squares, car, table, motion, wheels.velocity, total, moment)
    return least_squares(p.least_squares, car, motion, wheels.velocity, total, moment)
