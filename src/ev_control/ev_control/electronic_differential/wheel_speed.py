"""Rear wheels on the speeds of Ackermann's geometry: the electronic differential that Ge & Ni (2005) argue against."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import BrakeSplitParameters, split
from ev_core.law import REAR_WHEELS_DRIVEN, Car, Wheels, compilable, entry, group, method, only_driven, parameter, tan
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates, WheelTorqueRequest

KEEPS = ("torque", "speed")
TORQUE, SPEED = range(len(KEEPS))


@dataclass(frozen=True, slots=True)
class WheelSpeedParameters:
    """What of both wheels is commanded, and how firmly."""

    mean: str = parameter(
        "torque",
        choices=KEEPS,
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
    WheelSpeedParameters,
    state=WheelSpeedState,
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
    wanted = s.held if p.mean == SPEED else mean
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
