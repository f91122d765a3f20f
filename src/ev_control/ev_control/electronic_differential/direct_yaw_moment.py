"""Yaw moment control in exchangeable parts: reference, controller, allocation, known motion.

How it works: what the law knows of the motion (`known_motion`) gives the yaw rate that the driver
is taken to want (`reference`). The linear single-track car gives the moment that holds it there,
and a controller adds one by the errors. An allocation makes wheel torques of drive torque and
moment, and what motors and battery cannot give goes back to the integrals.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, split, split_brake
from ev_control.shared.allocation import Keep
from ev_control.shared.torque_split import KnownBy, differential
from ev_control.torque_vectoring.integral import MomentIntegral, follow_saturation
from ev_control.torque_vectoring.known_motion import (
    CarSeen,
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
from ev_control.torque_vectoring.predictive import Bounds, Errors, motion_over, predictive_moment
from ev_control.torque_vectoring.reference import (
    Bend,
    Reference,
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
from ev_core.law import Car, Choice, Vehicle, Wheels, compilable, group, parameter, part
from ev_core.vehicle.losses import NO_MAP, EfficiencyMap, efficiency_map
from ev_msgs_py.contract.signals import WheelTorqueRequest


class Controller(Choice):
    """Controllers that make a yaw moment of the errors."""

    PI = auto()
    LQR = auto()
    PREDICTIVE = auto()
    SLIDING_MODE = auto()
    SUPER_TWISTING = auto()
    SUBOPTIMAL = auto()


class Allocation(Choice):
    """Rules by which wheel torques make up a yaw moment."""

    AXLE = auto()
    LOAD = auto()
    LEAST_SQUARES = auto()
    LEAST_LOSS = auto()


@dataclass(frozen=True, slots=True)
class DirectYawMomentParameters:
    """Combination of parts, and the parameters of each."""

    reference: Reference = parameter(
        Reference.UNDERSTEER,
        about="wanted yaw rate: of a neutral car; of a designed understeer; or that with less "
        "where the rear slides",
    )
    controller: Controller = parameter(
        Controller.PI, about="what makes the yaw moment of the errors"
    )
    allocation: Allocation = parameter(
        Allocation.AXLE,
        about="torques: equal, and a fixed share of the moment on each axle; both as loads are; "
        "with the least use of grip within motors and tyres; or with the least loss of motors and "
        "inverters within them",
    )
    estimation: KnownBy = parameter(
        KnownBy.TRUTH,
        about="motion and friction: as the plant has them, or by sensors of a car alone",
    )
    feed_forward: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=2.0,
        about="share of the moment that the linear car needs for the wanted yaw rate",
    )
    largest_moment: float = parameter(
        6000.0, unit="N m", low=0.0, high=1e6, about="yaw moment that is asked for at most"
    )
    tracking_time: float = parameter(
        0.1,
        unit="s",
        low=0.001,
        high=10.0,
        about="time in which integrals follow a moment that saturates",
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
    limits: AllocationParameters = group(AllocationParameters, keep=Keep.DIFFERENCE)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class DirectYawMomentState:
    """State of the parts."""

    integral: MomentIntegral = part(MomentIntegral)
    suboptimal: SuboptimalState = part(SuboptimalState)
    wanted: ReferenceState = part(ReferenceState)
    known: KnownMotionState = part(KnownMotionState)


class DirectYawMomentConstants(NamedTuple):
    """Tables that follow from parameters and vehicle alone."""

    gains: Gains
    map: EfficiencyMap


def prepare(
    parameters: DirectYawMomentParameters, vehicle: Vehicle, period: float
) -> DirectYawMomentConstants:
    """Gains of the regulator by speed and map of the motors, where they are asked for."""
    gains, table = NO_GAINS, NO_MAP
    if parameters.controller in (Controller.LQR, Controller.PREDICTIVE):
        gains = lqr_gains(parameters.lqr, parameters.single_track, vehicle, period)
    if parameters.allocation == Allocation.LEAST_LOSS:
        table = efficiency_map(vehicle.motor)
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
    seen: CarSeen,
) -> WheelTorqueRequest:
    """Turn the car as the driver is taken to want, by torques that differ left and right.

    M_z = f (M_ff + J r*') + feedback(r - r*, v - v*), within +-`largest_moment`, whole from twice
    `slowest` on. M_ff holds the linear single-track car at the wanted yaw rate r*; v* is the
    lateral velocity that belongs to it. `ev_control.torque_vectoring` has each part with its
    source. Integrals follow what the allocation leaves of the moment. Where a measurement is
    absurd, all driven wheels get the same torque. Left positive.
    """
    driver, wheels = seen.driver, seen.sensors.wheels
    if not is_known(p.estimation, seen):
        return split(p.brake, car, driver, 0.0)
    motion = known_motion(p.known, car, s.known, period, p.estimation, seen)
    asked, fast = 0.0, faded_in(p.single_track, motion.speed)
    if fast == 0.0:
        # So slow nothing is wanted, and the lag of the reference begins anew from straight ahead.
        s.wanted.yaw_rate = 0.0
    else:
        asked = fast * wanted_moment(p, car, c.gains, s, period, motion)
        asked = min(max(asked, -p.largest_moment), p.largest_moment)
    drive = torques(p, car, c.map, motion, driver.drive_torque, asked)
    request = WheelTorqueRequest(drive, split_brake(p.brake, driver))
    request = allocated(p.limits, car, wheels, request)
    if fast > 0.0 and integrates(p.controller):
        # By load, left and right differ without a moment: only what saturation takes is missing.
        by_rule = p.allocation == Allocation.AXLE or p.allocation == Allocation.LOAD
        given = turned_by(car, drive) if by_rule else asked
        missing = given - turned_by(car, request.drive)
        follow_saturation(s.integral, period, p.tracking_time, missing)
    else:
        s.integral.moment = 0.0
    if fast == 0.0 or p.controller != Controller.SUBOPTIMAL:
        # An extremum from before means nothing when the controller begins again.
        forget_extrema(s.suboptimal)
    return request


@compilable
def integrates(controller: Controller) -> bool:
    """Return true for a controller with an integral."""
    return (
        controller == Controller.PI
        or controller == Controller.SUPER_TWISTING
        or controller == Controller.SUBOPTIMAL
    )


@compilable
def faded_in(p: SingleTrackParameters, speed: float) -> float:
    """Share of the moment at a speed [m/s]: none up to `slowest`, all from twice of it on [1]."""
    return min(max(abs(speed) / p.slowest - 1.0, 0.0), 1.0)


@compilable
def wanted_moment(
    p: DirectYawMomentParameters,
    car: Car,
    c: Gains,
    s: DirectYawMomentState,
    period: float,
    motion: KnownMotion,
) -> float:
    """Yaw moment [N m] that brings the car to the wanted motion and keeps it there."""
    u = motion.speed
    r = motion.yaw_rate
    a_y = motion.imu.lateral_acceleration
    # Lateral acceleration that all wheels together can hold [m/s^2].
    grip = ((motion.grip[0] + motion.grip[1]) + (motion.grip[2] + motion.grip[3])) / car.mass
    # Slip angle of the rear axle, small angles [rad].
    # Over |u|: in reverse, too, tyres push against their way aside.
    behind = -(motion.lateral - car.centre_of_mass_to_rear_axle * r) / abs(u)
    bend = Bend(u, motion.road_wheel_angle, grip, a_y, behind)
    wanted = wanted_motion(p.wanted, car, s.wanted, period, p.reference, bend)
    model = single_track(p.single_track, car, u)
    lateral = steady_lateral_velocity(model, wanted.angle, wanted.yaw_rate)
    # v* goes with r*: a car that yaws as wanted has the sideslip of the steady turn.
    errors = Errors(u, motion.lateral - lateral, r - wanted.yaw_rate)
    held = steady_moment(car, model, wanted.angle, wanted.yaw_rate)
    ahead = p.feed_forward * (held + car.yaw_inertia * wanted.rate)
    if p.controller != Controller.PREDICTIVE:
        return ahead + feedback(p, car, c, s, period, errors)
    # The programme plans within what can be given; the others are cut afterwards.
    most = min(p.largest_moment, motors_turn(car, motion.wheel_speed))
    # A small sideslip angle as a lateral velocity, as in the gains.
    aside = p.lqr.sideslip_error * max(abs(u), p.single_track.slowest)
    over = motion_over(p.lqr, car, model, period)
    return ahead + predictive_moment(p.lqr, c, over, aside, errors, Bounds(ahead, most))


@compilable
def feedback(
    p: DirectYawMomentParameters,
    car: Car,
    c: Gains,
    s: DirectYawMomentState,
    period: float,
    errors: Errors,
) -> float:
    """Moment of the chosen controller [N m]."""
    if p.controller == Controller.PI:
        return pi_moment(p.pi, car, s.integral, period, errors.yaw)
    if p.controller == Controller.LQR:
        return lqr_moment(c, errors.speed, errors.lateral, errors.yaw)
    if p.controller == Controller.SLIDING_MODE:
        return sliding_mode_moment(p.sliding_mode, car, errors.yaw)
    if p.controller == Controller.SUBOPTIMAL:
        return suboptimal_moment(p.suboptimal, car, s.suboptimal, s.integral, period, errors.yaw)
    return super_twisting_moment(p.super_twisting, car, s.integral, period, errors.yaw)


@compilable
def torques(
    p: DirectYawMomentParameters,
    car: Car,
    table: EfficiencyMap,
    motion: KnownMotion,
    total: float,
    moment: float,
) -> Wheels:
    """Drive torques by the chosen allocation [N m]."""
    if p.allocation == Allocation.AXLE:
        return by_axle(p.axle, car, total, moment)
    if p.allocation == Allocation.LOAD:
        return by_load(car, motion.imu, total, moment)
    if p.allocation == Allocation.LEAST_LOSS:
        return least_loss(p.least_squares, car, table, motion, total, moment)
    return least_squares(p.least_squares, car, motion, total, moment)
