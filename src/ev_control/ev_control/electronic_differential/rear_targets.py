"""Rear wheels driven to target slips (Ge & Ni 2005), or to speeds of Ackermann's geometry."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation.plausible import Sensors
from ev_control.estimation.reference_speed import free_wheel_speed
from ev_control.estimation.slip_peak import (
    RearSlips,
    RoadTargetParameters,
    RoadTargetState,
    forget_road,
    most_by_road,
)
from ev_control.law import BrakeSplitParameters, split
from ev_control.shared.torque_split import KnownBy, differential
from ev_core.law import (
    BodyVelocity,
    Choice,
    Wheels,
    WheelStates,
    copysign,
    entry,
    group,
    parameter,
    part,
    setting,
    tan,
)
from ev_core.vehicle.car import REAR_WHEELS_DRIVEN, Car, only_driven, speed_along_path
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelTorqueRequest


class Reading(Choice):
    """Readings of what the switching control changes."""

    RATE = auto()
    OFFSET = auto()
    INCREMENT = auto()


class KeptMean(Choice):
    """Mean of both wheels that is kept: of their torques, or of their speeds."""

    TORQUE = auto()
    SPEED = auto()


@compilable
def slip_ratio(wheel_speed: float, ground_speed: float, slowest: float) -> float:
    """Slip ratio [1] of Ge & Ni (2005): (w R - V)/(w R) driving, (w R - V)/V braking.

    `wheel_speed` is w R and `ground_speed` the velocity V of the wheel's centre along the wheel
    [m/s]; the divisor is the larger of both magnitudes, and at least `slowest` [m/s], above zero,
    so that a car at rest has no slip.
    """
    return (wheel_speed - ground_speed) / max(abs(wheel_speed), abs(ground_speed), slowest)


@dataclass(frozen=True, slots=True)
class SlipTargetParameters:
    """Target slip ratios, and gains and boundary layer of the control that drives the wheels there.

    What the control changes is left open by the source's damaged scan.
    """

    reading: Reading = parameter(
        Reading.RATE,
        about="what the switching control changes: the torque per second (rate), the torque "
        "itself (offset), or the torque per control period (increment)",
        source="Ge & Ni 2005; the scan leaves it open",
    )
    k_inner: float = parameter(
        50.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the inner wheel, k_L of a left turn, and of both straight ahead; "
        "for the reading rate per second",
        source="Ge & Ni 2005",
    )
    k_outer: float = parameter(
        100.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the outer wheel, k_R of a left turn; for the reading rate per "
        "second",
        source="Ge & Ni 2005",
    )
    boundary_layer: bool = setting(
        True, about="whether the control is linear within the boundary layer"
    )
    layer_width: float = parameter(
        0.001,
        unit="1",
        low=1e-6,
        high=1.0,
        about="half width of the boundary layer, phi",
        source="Ge & Ni 2005",
    )
    largest_correction: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=1.0,
        about="limit of a wheel's change over its share: no torque without the pedal",
    )
    source: KnownBy = parameter(
        KnownBy.TRUTH,
        about="body velocity: as the twist topic gives it, or from the free front wheels and the "
        "yaw rate sensor",
        source="Ge & Ni 2005 use the true one",
    )
    target_slip: float = parameter(
        0.19,
        unit="1",
        low=0.0,
        high=1.0,
        about="target slip ratio of the inner wheel, l3*",
        source="Ge & Ni 2005",
    )
    road: RoadTargetParameters = group(RoadTargetParameters)
    yaw_gain: float = parameter(
        0.11,
        unit="s/rad",
        low=0.0,
        high=10.0,
        about="difference of the target slip ratios per error of the yaw rate, K1",
        source="Ge & Ni 2005, print damaged",
    )
    slowest: float = parameter(
        0.5, unit="m/s", low=0.01, high=10.0, about="least divisor of a slip ratio"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@compilable
def corrected(
    p: SlipTargetParameters,
    period: float,
    correction: float,
    outer: bool,
    error: float,
    limit: float,
) -> float:
    """The next correction c of a wheel [N m] by its slip error D [1], within the limit [N m].

    s = k sat(D/phi), or k sgn(D) without boundary layer: dc/dt = s (reading rate), c = s (offset),
    or c grows by s in each control period (increment). Ge & Ni (2005); their printed k = D/phi
    drops the gain.
    """
    gain = p.k_outer if outer else p.k_inner
    if p.boundary_layer:
        switched = min(max(error / p.layer_width, -1.0), 1.0)
    else:
        switched = copysign(1.0, error) if error != 0.0 else 0.0
    # An increment depends on the control period; rate and offset do not.
    change = gain * (period if p.reading == Reading.RATE else 1.0) * switched
    return min(max(change if p.reading == Reading.OFFSET else correction + change, -limit), limit)


@dataclass(slots=True)
class SlipTargetState:
    """State of the corrections, and of the road."""

    left: float = entry(
        unit="N m", about="what the control has added to the equal torque of the left rear wheel"
    )
    right: float = entry(unit="N m", about="the same of the right one")
    road: RoadTargetState = part(RoadTargetState)


class SlipTargetSeen(NamedTuple):
    """Signals that the law reads."""

    driver: DriverCommand
    sensors: Sensors
    body: BodyVelocity


@differential(
    "slip_target",
    needs=(REAR_WHEELS_DRIVEN, only_driven("rear_left", "rear_right")),
)
@compilable
def slip_target(
    p: SlipTargetParameters,
    car: Car,
    s: SlipTargetState,
    period: float,
    seen: SlipTargetSeen,
) -> WheelTorqueRequest:
    """Drive each rear wheel towards a target slip, with a difference by the yaw rate error.

    In a left turn l_R* = l_L* - K1 (r - delta V/L), D_i = l_i* - l_i, and T = T* + c with the
    switching control c of D (`corrected`; Ge & Ni 2005). T* is half of the driver's torque [N m];
    slip ratios [1], yaw rate r [rad/s], road- wheel angle delta [rad], left positive. A right turn
    is the mirror image (the source drives left only), and straight ahead both wheels count as inner
    ones. Each |c| stays below largest_correction T*, and the correction is dropped while the driver
    asks for no drive torque or brakes.
    """
    driver = seen.driver
    sensors = seen.sensors
    body = seen.body
    wheels = sensors.wheels
    imu = sensors.imu
    delta = sensors.column.road_wheel_angle
    equal = split(p.brake, car, driver, 0.0)
    if driver.drive_torque <= 0.0 or driver.brake_torque > 0.0:
        s.left = 0.0
        s.right = 0.0
        forget_road(s.road)
        return equal
    if p.source == KnownBy.TRUTH:
        yaw_rate = body.yaw_rate
        u, speed = body.longitudinal, speed_along_path(body)
    else:
        yaw_rate = imu.yaw_rate
        u = free_wheel_speed(car, wheels.velocity, delta, yaw_rate)
        speed = u
    # The wheel centres move at u -+ r B/2 along the car: the outer one is faster.
    side = yaw_rate * car.rear_track / 2.0
    slip_left = slip_ratio(wheels.velocity.rear_left * car.wheel_radius, u - side, p.slowest)
    slip_right = slip_ratio(wheels.velocity.rear_right * car.wheel_radius, u + side, p.slowest)
    # A car that yaws more than Ackermann's geometry asks for gets less slip at its outer wheel.
    difference = p.yaw_gain * (yaw_rate - delta * speed / car.wheelbase)
    share = equal.drive.rear_left
    # Without the pedal there is no share, and so no correction.
    limit = p.largest_correction * share
    # Straight ahead the yaw rate shows which wheel is outside.
    turn = delta if delta != 0.0 else yaw_rate
    outer_left, outer_right = turn < 0.0, turn > 0.0
    # The road may allow less than the given target.
    slips = RearSlips(slip_left, slip_right)
    target = min(p.target_slip, most_by_road(p.road, car, s.road, period, wheels, slips))
    target_left = target + difference if outer_left else target
    target_right = target - difference if outer_right else target
    s.left = corrected(p, period, s.left, outer_left, target_left - slip_left, limit)
    s.right = corrected(p, period, s.right, outer_right, target_right - slip_right, limit)
    return WheelTorqueRequest(Wheels(0.0, 0.0, share + s.left, share + s.right), equal.brake)


@dataclass(frozen=True, slots=True)
class WheelSpeedParameters:
    """Quantity of both wheels that is commanded, and how firmly."""

    mean: KeptMean = parameter(
        KeptMean.TORQUE,
        about="torque: the torques add up to the driver's, only the difference of the speeds is "
        "commanded; speed: both speeds are, and their mean is held where it was when the pedal "
        "was pressed",
        source="assumption; Ge & Ni 2005 speak of the speed of each wheel as what is controlled",
    )
    proportional_gain: float = parameter(
        500.0,
        unit="N m s/rad",
        low=0.0,
        high=1e5,
        about="torque of each wheel per error of its speed",
        source="assumption: as much as the tyre of their car itself",
    )
    integral_gain: float = parameter(
        2500.0,
        unit="N m/rad",
        low=0.0,
        high=1e6,
        about="torque of each wheel per integral of that error",
        source="assumption: 0.2 s",
    )
    largest_correction: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=1.0,
        about="limit of the change of torque over the equal share, of each of both loops, so that "
        "no torque comes without the pedal",
        source="assumption, as in slip_target",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class WheelSpeedState:
    """State of both control loops."""

    difference: float = entry(
        unit="N m", about="integral part of half the torque difference, right minus left"
    )
    mean: float = entry(unit="N m", about="integral part of the change of both torques")
    held: float = entry(unit="rad/s", about="mean speed that is held")
    holds: bool = entry(False, unit="1", about="whether one is")


class WheelSpeedSeen(NamedTuple):
    """Signals that the law reads."""

    driver: DriverCommand
    column: SteeringColumnState
    wheels: WheelStates


@differential(
    "wheel_speed",
    needs=(REAR_WHEELS_DRIVEN, only_driven("rear_left", "rear_right")),
)
@compilable
def wheel_speed(
    p: WheelSpeedParameters,
    car: Car,
    s: WheelSpeedState,
    period: float,
    seen: WheelSpeedSeen,
) -> WheelTorqueRequest:
    """Hold the rear wheels to speeds with which they roll about the centre of Ackermann's geometry.

    w_L* = w (1 - k), w_R* = w (1 + k), k = B tan(delta)/(2 L), by the torques T -+ c of a PI
    control of the difference, with the road-wheel angle delta [rad], left positive, and half of the
    driver's torque T [N m]. The mean speed w [rad/s] is the measured one, or with `mean` speed held
    by a second PI control. Each |c| stays below largest_correction |T|. Nothing is corrected
    without drive torque or while the driver brakes. Ge & Ni (2005) say in words what speaks against
    such a control by the model of Ackermann and Jeantaud; the law is ours.
    """
    driver, wheels = seen.driver, seen.wheels
    equal = split(p.brake, car, driver, 0.0)
    share = equal.drive.rear_left
    if share == 0.0 or driver.brake_torque > 0.0:
        s.difference = 0.0
        s.mean = 0.0
        s.holds = False
        return equal
    left, right = wheels.velocity.rear_left, wheels.velocity.rear_right
    mean, limit = (left + right) / 2.0, p.largest_correction * abs(share)
    # The speed at which the pedal was pressed.
    if not s.holds:
        s.held = mean
        s.holds = True
    wanted = s.held if p.mean == KeptMean.SPEED else mean
    # Half the difference of the speeds: w B tan(delta)/(2 L), the outer wheel faster.
    turned = wanted * car.rear_track * tan(seen.column.road_wheel_angle) / (2.0 * car.wheelbase)
    error = turned - (right - left) / 2.0
    difference = s.difference + p.integral_gain * period * error
    s.difference = min(max(difference, -limit), limit)
    average = s.mean + p.integral_gain * period * (wanted - mean)
    s.mean = min(max(average, -limit), limit)
    # Integral and sum are limited alike, so an integral at its limit leaves it as soon as the error
    # turns.
    half = min(max(p.proportional_gain * error + s.difference, -limit), limit)
    both = min(max(p.proportional_gain * (wanted - mean) + s.mean, -limit), limit)
    return WheelTorqueRequest(
        Wheels(0.0, 0.0, share + both - half, share + both + half), equal.brake
    )
