"""Torques of the wheels where motors or battery cannot give all that a law asks for.

A law that asks left and right for different torques asks for a sum, which drives, and for a
difference, which turns or steers. Asked for more than it has each motor cuts its own part, and both
change. Here one of the two stays.
"""

from dataclasses import dataclass
from enum import auto
from typing import Any, NamedTuple

from ev_core.elementary import copysign, isfinite
from ev_core.law import (
    NO_WHEELS,
    Car,
    Choice,
    Vehicle,
    Wheels,
    WheelStates,
    WheelTorqueRequest,
    compilable,
    parameter,
)
from ev_core.vehicle.driveline import has_own_motors
from ev_core.vehicle.motor import driving_torque, generating_torque


class Keep(Choice):
    """Quantity that stays where motors or battery cannot give all that is asked for."""

    ASKED = auto()
    SUM = auto()
    DIFFERENCE = auto()


@dataclass(frozen=True, slots=True)
class AllocationParameters:
    """Choice of what stays where motors or battery saturate."""

    keep: Keep = parameter(
        Keep.ASKED,
        about="what stays where motors or battery cannot give all: asked: the request, each motor "
        "cuts its own part; sum: other wheels give what one cannot; difference: that of each "
        "axle, and the sum yields",
        source="assumption: the sources have no limits",
    )
    efficiency: float = parameter(
        0.9,
        unit="1",
        low=0.1,
        high=1.0,
        about="motors' mechanical over electrical power while the battery discharges",
    )


class Range(NamedTuple):
    """The torques that a wheel can get [N m]; zero is always one of them."""

    least: float
    most: float


class AxleTorques(NamedTuple):
    """Torques of the wheels of an axle [N m]."""

    left: float
    right: float


def own_motors_to_allocate(parameters: Any, vehicle: Vehicle) -> str:
    """Only wheels with motors of their own have limits of their own."""
    if parameters.allocation.keep == Keep.ASKED or (
        has_own_motors(vehicle) and vehicle.engine.peak_power == 0.0
    ):
        return ""
    return f"a motor for each driven wheel for allocation.keep {parameters.allocation.keep.text}"


@compilable
def allocated(
    p: AllocationParameters, car: Car, wheels: WheelStates, request: WheelTorqueRequest
) -> WheelTorqueRequest:
    """Request with drive torques [N m] that motors and battery can give at these wheel speeds.

    Where nothing saturates it is the request, to the bit, and so it is where a speed is not finite.
    The sum is never of more magnitude than asked for, and with `sum` no wheel gets the other sign.
    Known are the numbers of the description: peak torque, power and speed of the motors, power of
    the battery; not heat, voltage or charge, and not what brakes are blended.
    """
    asked, speed = request.drive, wheels.velocity
    # A speed that is no number has no power: the motors cut as they will.
    if p.keep == Keep.ASKED or not isfinite((speed[0] + speed[1]) + (speed[2] + speed[3])):
        return request
    a = motor_range(car, 0, speed[0])
    b = motor_range(car, 1, speed[1])
    c = motor_range(car, 2, speed[2])
    d = motor_range(car, 3, speed[3])
    least = NO_WHEELS
    if p.keep == Keep.DIFFERENCE:
        front = with_difference(asked[0], asked[1], a, b)
        rear = with_difference(asked[2], asked[3], c, d)
        # Axles that work against each other: where one yields, the other may not take over the sum.
        total = (asked[0] + asked[1]) + (asked[2] + asked[3])
        had = (front.left + front.right) + (rear.left + rear.right)
        excess = had - min(max(had, min(total, 0.0)), max(total, 0.0))
        front = with_less(front, excess, a, b)
        rear = with_less(rear, excess, c, d)
        # Only axles that do not work against each other can give up their sums together.
        if (front.left + front.right) * (rear.left + rear.right) >= 0.0:
            front_alone = difference_alone(front, a, b)
            rear_alone = difference_alone(rear, c, d)
            least = Wheels(front_alone.left, front_alone.right, rear_alone.left, rear_alone.right)
    else:
        a = of_sign(a, asked[0])
        b = of_sign(b, asked[1])
        c = of_sign(c, asked[2])
        d = of_sign(d, asked[3])
        front = AxleTorques(within(a, asked[0]), within(b, asked[1]))
        rear = AxleTorques(within(c, asked[2]), within(d, asked[3]))
        front = filled(front, (asked[0] + asked[1]) - (front.left + front.right), a, b)
        rear = filled(rear, (asked[2] + asked[3]) - (rear.left + rear.right), c, d)
        # What is missing now is missing on one axle, which is full.
        missing = (asked[0] + asked[1]) - (front.left + front.right)
        missing += (asked[2] + asked[3]) - (rear.left + rear.right)
        front = filled(front, missing, a, b)
        rear = filled(rear, missing, c, d)
    drive = Wheels(front.left, front.right, rear.left, rear.right)
    return WheelTorqueRequest(within_battery(p, car, speed, drive, least), request.brake)


@compilable
def motor_range(car: Car, wheel: int, speed: float) -> Range:
    """Torques that the motors of a wheel can give at a wheel speed [rad/s]; zero without motors."""
    motor = car.motor
    at_wheel = car.driven[wheel] * car.motors[wheel] * car.gear[wheel]
    turns = abs(speed) * car.gear[wheel]
    driving = at_wheel * driving_torque(motor, motor.peak_torque, 1.0, turns)
    generating = at_wheel * generating_torque(motor, motor.peak_torque, 1.0, turns)
    if speed == 0.0:
        return Range(-driving, driving)
    return Range(-generating, driving) if speed > 0.0 else Range(-driving, generating)


@compilable
def within(can: Range, torque: float) -> float:
    """A torque within what a wheel can get [N m]."""
    return min(max(torque, can.least), can.most)


@compilable
def of_sign(can: Range, asked: float) -> Range:
    """The part of a range that has the sign of what is asked; all of it where nothing is."""
    return Range(can.least if asked <= 0.0 else 0.0, can.most if asked >= 0.0 else 0.0)


@compilable
def with_difference(
    asked_left: float, asked_right: float, left: Range, right: Range
) -> AxleTorques:
    """Torques with the asked difference, and a sum as near to the asked one as it can be.

    The sum lies between none and the asked one. Where no such sum leaves room for the difference,
    it is the largest one with its sign.
    """
    if within(left, asked_left) == asked_left and within(right, asked_right) == asked_right:
        return AxleTorques(asked_left, asked_right)
    # The difference is kept, so only the mean may move, and the larger torque sets the room.
    mean, half = (asked_left + asked_right) / 2.0, (asked_right - asked_left) / 2.0
    lower, upper = (left, right) if half >= 0.0 else (right, left)
    # With the whole difference, with the larger of the means, with the smaller one.
    room = min(
        (upper.most - lower.least) / 2.0,
        max(mean, 0.0) - lower.least,
        upper.most - min(mean, 0.0),
    )
    return at_mean(mean, copysign(min(abs(half), room), half), left, right)


@compilable
def with_less(torques: AxleTorques, excess: float, left: Range, right: Range) -> AxleTorques:
    """The torques with a sum that is smaller by `excess` [N m], if it has that sign."""
    if (torques.left + torques.right) * excess <= 0.0:
        return torques
    return with_difference(torques.left - excess / 2.0, torques.right - excess / 2.0, left, right)


@compilable
def difference_alone(torques: AxleTorques, left: Range, right: Range) -> AxleTorques:
    """The difference of possible torques with as little of a sum as it can be had with."""
    return at_mean(0.0, (torques.right - torques.left) / 2.0, left, right)


@compilable
def at_mean(mean: float, half: float, left: Range, right: Range) -> AxleTorques:
    """Torques with half a difference and a mean as near to `mean` as both wheels can [N m]."""
    least = max(left.least + half, right.least - half)
    most = min(left.most + half, right.most - half)
    mean = min(max(mean, least), most)
    return AxleTorques(mean - half, mean + half)


@compilable
def filled(torques: AxleTorques, missing: float, left: Range, right: Range) -> AxleTorques:
    """Torques with what is `missing` [N m] added.

    Each wheel gets half, and what the other one has no room for.
    """
    if missing == 0.0:
        return torques
    if missing > 0.0:
        left_room, right_room = left.most - torques.left, right.most - torques.right
    else:
        left_room, right_room = torques.left - left.least, torques.right - right.least
    # Half each, unless one side has less room than that.
    more = abs(missing)
    to_left = min(left_room, max(more / 2.0, more - right_room))
    to_right = min(right_room, max(more / 2.0, more - left_room))
    return AxleTorques(
        torques.left + copysign(to_left, missing), torques.right + copysign(to_right, missing)
    )


@compilable
def within_battery(
    p: AllocationParameters, car: Car, speed: Wheels, drive: Wheels, least: Wheels
) -> Wheels:
    """Torques [N m] within the power of the battery, between `drive`, `least` and none."""
    battery = car.battery
    give = p.efficiency * max(battery.discharge_power - battery.auxiliary_power, 0.0)
    take = battery.charge_power + battery.auxiliary_power
    power = mechanical_power(drive, speed)
    if -take <= power <= give:
        return drive
    limit = give if power > give else -take
    left = mechanical_power(least, speed)
    # Even the least torques exceed the battery: the rest is cut towards none.
    if left != limit and (left > limit) == (power > limit):
        return between(NO_WHEELS, least, limit / left)
    return between(least, drive, (limit - left) / (power - left))


@compilable
def mechanical_power(torque: Wheels, speed: Wheels) -> float:
    """Power of the motors [W], left and right first: a mirrored car gets the same number."""
    return (torque[0] * speed[0] + torque[1] * speed[1]) + (
        torque[2] * speed[2] + torque[3] * speed[3]
    )


@compilable
def between(one: Wheels, other: Wheels, share: float) -> Wheels:
    """Torques [N m] at a share of the way from one to the other."""
    return Wheels(
        one[0] + share * (other[0] - one[0]),
        one[1] + share * (other[1] - one[1]),
        one[2] + share * (other[2] - one[2]),
        one[3] + share * (other[3] - one[3]),
    )
