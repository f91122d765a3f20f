"""Rear wheels driven to targets: slip ratios by the yaw rate (Ge & Ni 2005), or the speeds of Ackermann's geometry."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.reference_speed import free_wheel_speed
from ev_control.estimation.slip_peak import RoadTargetParameters, RoadTargetState, forget_road, target_by_road
from ev_control.law import BrakeSplitParameters, split
from ev_control.shared.torque_split import KNOWN_BY, TRUTH, differential
from ev_core.law import BodyVelocity, Wheels, WheelStates, copysign, entry, group, method, parameter, part, setting, tan
from ev_core.vehicle.car import REAR_WHEELS_DRIVEN, Car, only_driven, speed_along_path
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import DriverCommand, InertialMeasurement, SteeringColumnState, WheelTorqueRequest


@compilable
def slip_ratio(wheel_speed: float, ground_speed: float, slowest: float) -> float:
    """Slip ratio [1], positive in traction: (w R - V)/(w R) driving, (w R - V)/V braking (Ge & Ni 2005).

    `wheel_speed` is w R and `ground_speed` the velocity V of the wheel's centre along the wheel [m/s]; the divisor is
    the larger of both magnitudes, and at least `slowest` [m/s], above zero, so that a car at rest has no slip.
    """
    return (wheel_speed - ground_speed) / max(abs(wheel_speed), abs(ground_speed), slowest)


CONTROL_READINGS = ("rate", "offset", "increment")
AS_RATE, AS_OFFSET, AS_INCREMENT = range(len(CONTROL_READINGS))


@dataclass(frozen=True, slots=True)
class SlipTargetParameters:
    """Target slip ratios, and gains and boundary layer of the control that drives the wheels there.

    What the control changes is left open by the source's damaged scan.
    """

    reading: str = parameter(
        "rate",
        choices=CONTROL_READINGS,
        about="what the switching control changes: the torque per second (rate), the torque itself (offset), or the "
        "torque per control period (increment)",
        source="Ge & Ni 2005; the scan leaves it open",
    )
    k_inner: float = parameter(
        50.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the inner wheel, k_L of a left turn, and of both straight ahead; for the reading rate "
        "per second",
        source="Ge & Ni 2005",
    )
    k_outer: float = parameter(
        100.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the outer wheel, k_R of a left turn; for the reading rate per second",
        source="Ge & Ni 2005",
    )
    boundary_layer: bool = setting(True, about="whether the control is linear within the boundary layer")
    layer_width: float = parameter(
        0.001, unit="1", low=1e-6, high=1.0, about="half width of the boundary layer, phi", source="Ge & Ni 2005"
    )
    largest_correction: float = parameter(
        0.5, unit="1", low=0.0, high=1.0, about="limit of a wheel's change over its share: no torque without the pedal"
    )
    source: str = parameter(
        "truth",
        choices=KNOWN_BY,
        about="body velocity: as the twist topic gives it, or from the free front wheels and the yaw rate sensor",
        source="Ge & Ni 2005 use the true one",
    )
    target_slip: float = parameter(
        0.19, unit="1", low=0.0, high=1.0, about="target slip ratio of the inner wheel, l3*", source="Ge & Ni 2005"
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
    slowest: float = parameter(0.5, unit="m/s", low=0.01, high=10.0, about="least divisor of a slip ratio")
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@compilable
def corrected(
    p: SlipTargetParameters, period: float, correction: float, outer: bool, error: float, limit: float
) -> float:
    """The next correction c of a wheel [N m] by its slip error D [1], within the limit [N m].

    s = k sat(D/phi), or k sgn(D) without boundary layer: dc/dt = s (reading rate), c = s (offset), or c grows by s in
    each control period (increment). Ge & Ni (2005), whose printed k = D/phi drops the gain.
    """
    gain = p.k_outer if outer else p.k_inner
    if p.boundary_layer == 1.0:
        switched = min(max(error / p.layer_width, -1.0), 1.0)
    else:
        switched = copysign(1.0, error) if error != 0.0 else 0.0
    change = gain * (period if p.reading == AS_RATE else 1.0) * switched
    return min(max(change if p.reading == AS_OFFSET else correction + change, -limit), limit)


@dataclass(slots=True)
class SlipTargetState:
    """What lasts between steps."""

    left: float = entry(unit="N m", about="what the control has added to the equal torque of the left rear wheel")
    right: float = entry(unit="N m", about="the same of the right one")
    road: RoadTargetState = part(RoadTargetState)


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
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    body: BodyVelocity,
) -> WheelTorqueRequest:
    """Drive each rear wheel towards a target slip ratio, with a slip difference that follows the yaw rate error.

    In a left turn l_R* = l_L* - K1 (r - delta V/L), D_i = l_i* - l_i, and T = T* + c with the switching control c of D
    (`corrected`; Ge & Ni 2005). T* is half of the driver's torque [N m]; slip ratios [1], yaw rate r [rad/s], road-
    wheel angle delta [rad], left positive. A right turn is the mirror image (the source drives left only), and straight
    ahead both wheels count as inner ones. Each |c| stays below largest_correction T*, and the correction is dropped
    while the driver asks for no drive torque or brakes.
    """
    equal, delta = split(p.brake, car, driver, 0.0), column.road_wheel_angle
    if driver.drive_torque <= 0.0 or driver.brake_torque > 0.0:
        s.left, s.right = 0.0, 0.0
        forget_road(s.road)
        return equal
    if p.source == TRUTH:
        u, speed, yaw_rate = body.longitudinal, speed_along_path(body), body.yaw_rate
    else:
        u, yaw_rate = free_wheel_speed(car, wheels.velocity, delta, imu.yaw_rate), imu.yaw_rate
        speed = u
    side = yaw_rate * car.rear_track / 2.0
    slip_left = slip_ratio(wheels.velocity.rear_left * car.wheel_radius, u - side, p.slowest)
    slip_right = slip_ratio(wheels.velocity.rear_right * car.wheel_radius, u + side, p.slowest)
    difference = p.yaw_gain * (yaw_rate - delta * speed / car.wheelbase)
    share = equal.drive.rear_left
    limit = p.largest_correction * share
    turn = delta if delta != 0.0 else yaw_rate
    outer_left, outer_right = turn < 0.0, turn > 0.0
    target = target_by_road(p.road, car, s.road, period, wheels, slip_left, slip_right, p.target_slip)
    target_left = target + difference if outer_left else target
    target_right = target - difference if outer_right else target
    s.left = corrected(p, period, s.left, outer_left, target_left - slip_left, limit)
    s.right = corrected(p, period, s.right, outer_right, target_right - slip_right, limit)
    return WheelTorqueRequest(Wheels(0.0, 0.0, share + s.left, share + s.right), equal.brake)


KEPT_MEANS = ("torque", "speed")
KEPT_TORQUE, KEPT_SPEED = range(len(KEPT_MEANS))


@dataclass(frozen=True, slots=True)
class WheelSpeedParameters:
    """What of both wheels is commanded, and how firmly."""

    mean: str = parameter(
        "torque",
        choices=KEPT_MEANS,
        about="torque: the torques add up to the driver's, only the difference of the speeds is commanded; speed: both "
        "speeds are, and their mean is held where it was when the pedal was pressed",
        source="assumption; Ge & Ni 2005 speak of the speed of each wheel as what is controlled",
    )
    proportional_gain: float = parameter(
        500.0, unit="N m s/rad", low=0.0, high=1e5, about="torque of each wheel per error of its speed",
        source="assumption: as much as the tyre of their car itself",
    )  # fmt: skip
    integral_gain: float = parameter(
        2500.0, unit="N m/rad", low=0.0, high=1e6, about="torque of each wheel per integral of that error",
        source="assumption: 0.2 s",
    )  # fmt: skip
    largest_correction: float = parameter(
        0.5, unit="1", low=0.0, high=1.0, about="limit of the change of torque over the equal share, of each of both "
        "loops, so that no torque comes without the pedal",
        source="assumption, as in slip_target",
    )  # fmt: skip
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class WheelSpeedState:
    """What lasts between steps."""

    difference: float = entry(unit="N m", about="integral part of half the torque difference, right minus left")
    mean: float = entry(unit="N m", about="integral part of the change of both torques")
    held: float = entry(unit="rad/s", about="mean speed that is held")
    holds: float = entry(unit="1", about="whether one is")


@method(
    "electronic_differential",
    "wheel_speed",
    needs=(REAR_WHEELS_DRIVEN, only_driven("rear_left", "rear_right")),
    mirrored=True,
)
@compilable
def wheel_speed(
    p: WheelSpeedParameters,
    car: Car,
    s: WheelSpeedState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Hold the rear wheels to the speeds with which they would roll about the centre of Ackermann's geometry.

    w_L* = w (1 - k), w_R* = w (1 + k), k = B tan(delta)/(2 L), by the torques T -+ c of a PI control of the difference,
    with the road-wheel angle delta [rad], left positive, and half of the driver's torque T [N m]. The mean speed w
    [rad/s] is the measured one, or with `mean` speed held by a second PI control. Each |c| stays below
    largest_correction |T|. Nothing is corrected without drive torque or while the driver brakes. Ge & Ni (2005) say in
    words what speaks against such a control by the model of Ackermann and Jeantaud; the law is ours.
    """
    equal = split(p.brake, car, driver, 0.0)
    share = equal.drive.rear_left
    if share == 0.0 or driver.brake_torque > 0.0:
        s.difference, s.mean, s.holds = 0.0, 0.0, 0.0
        return equal
    left, right = wheels.velocity.rear_left, wheels.velocity.rear_right
    mean, limit = (left + right) / 2.0, p.largest_correction * abs(share)
    if s.holds == 0.0:
        s.held, s.holds = mean, 1.0
    wanted = s.held if p.mean == KEPT_SPEED else mean
    turned = wanted * car.rear_track * tan(column.road_wheel_angle) / (2.0 * car.wheelbase)
    error = turned - (right - left) / 2.0
    s.difference = limited(s.difference + p.integral_gain * period * error, limit)
    s.mean = limited(s.mean + p.integral_gain * period * (wanted - mean), limit)
    half = limited(p.proportional_gain * error + s.difference, limit)
    both = limited(p.proportional_gain * (wanted - mean) + s.mean, limit)
    return WheelTorqueRequest(Wheels(0.0, 0.0, share + both - half, share + both + half), equal.brake)


@compilable
def limited(value: float, limit: float) -> float:
    """A value within +-limit."""
    return min(max(value, -limit), limit)
