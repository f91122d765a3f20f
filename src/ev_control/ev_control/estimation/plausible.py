"""Readings that no road vehicle can produce, and wheel speeds that contradict the speed of the car.

How it works: a sensor that is dead, stuck, wrong or swapped contradicts the speed of the car. A
driven wheel cannot turn slower than it rolls, nor a braked wheel faster. A wheel without motor and
brake torque rolls. No wheel keeps its speed to the bit while the others and the accelerometer show
that the car changes its own. A reading beyond that, by more than tyres and bends explain, is
excluded at once, and the sensor counts as lost if that lasts.

A driven wheel that turns faster may be slipping. So a sensor that reads too much cannot be
distinguished from a spinning wheel, and is not found. A wheel in the air, which nothing slows down
in the model, counts as stuck. This is an assumption of this project, without a source.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import (
    Car,
    InertialMeasurement,
    SteeringColumnState,
    Wheels,
    WheelStates,
    compilable,
    entry,
    per_wheel,
    setting,
)

# Beyond these a number is no measurement of a road vehicle: 3 km/s at the tyre, a hundred motors, a
# collision.
LARGEST_SPEED = 1e4  # [rad/s]
LARGEST_TORQUE = 1e6  # [N m]
LARGEST_ACCELERATION = 1e3  # [m/s^2]
LARGEST_YAW_RATE = 1e2  # [rad/s]
LARGEST_ANGLE = 1.5  # [rad]


class Sensors(NamedTuple):
    """Signals of the sensors that every car has."""

    column: SteeringColumnState
    wheels: WheelStates
    imu: InertialMeasurement


@compilable
def is_plausible(sensors: Sensors) -> bool:
    """Return true if all that is measured is finite and could be a road vehicle's."""
    wheels, imu = sensors.wheels, sensors.imu
    along, across = imu.longitudinal_acceleration, imu.lateral_acceleration
    return (
        sum_of_squares(wheels.velocity) < LARGEST_SPEED * LARGEST_SPEED
        and sum_of_squares(wheels.effort) < LARGEST_TORQUE * LARGEST_TORQUE
        and along * along + across * across < LARGEST_ACCELERATION * LARGEST_ACCELERATION
        and abs(imu.yaw_rate) < LARGEST_YAW_RATE
        and abs(sensors.column.road_wheel_angle) < LARGEST_ANGLE
    )


@compilable
def sum_of_squares(of: Wheels) -> float:
    """Sum of the squares, left and right first: a mirrored car gets the same number."""
    return (of[0] * of[0] + of[1] * of[1]) + (of[2] * of[2] + of[3] * of[3])


@dataclass(frozen=True, slots=True)
class WheelTrustParameters:
    """Limits beyond which a wheel speed is not believed; all of it is assumed."""

    watch: bool = setting(
        False, about="whether wheel speeds that cannot be are left out; else all are believed"
    )
    tolerance: float = setting(
        0.3,
        unit="m/s",
        low=0.01,
        high=100.0,
        about="deviation from the speed of the car that is allowed",
    )
    share: float = setting(
        0.1, unit="1", low=0.0, high=1.0, about="of the speed of the car, allowed besides"
    )
    time: float = setting(
        0.1, unit="s", low=0.0, high=10.0, about="of deviation until a sensor counts as lost"
    )
    recovery: float = setting(
        1.0, unit="s", low=0.01, high=100.0, about="of agreement until a lost one is believed again"
    )


@dataclass(slots=True)
class WheelTrustState:
    """Trust in the four sensors."""

    doubt: list[float] = per_wheel(unit="1", about="grows to 1 by deviation, falls by agreement")
    lost: list[float] = per_wheel(unit="1", about="1 while the sensor counts as lost")
    left_out: list[float] = per_wheel(unit="1", about="1 where it is left out in this step")
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    others: list[float] = per_wheel(
        unit="rad/s", about="sum of the other speeds when it last changed"
    )
    gained: list[float] = per_wheel(
        unit="m/s", about="by the accelerometer since it last changed, not at rest"
    )
    known: bool = entry(
        False, unit="1", about="whether there is a speed of the car to compare with"
    )


class SpeedEvidence(NamedTuple):
    """Speeds of a step by which the wheels are judged."""

    velocity: Wheels  # of the wheels [rad/s]
    by_wheel: Wheels  # speed of the car that each wheel means if it rolls [m/s]
    expected: float  # speed of the car [m/s]
    gained: float  # by the car in the period [m/s]
    direction: (
        float  # sign of what drives are asked for; against the travel while the car is braked
    )


@compilable
def judge_wheels(
    p: WheelTrustParameters, car: Car, s: WheelTrustState, period: float, seen: SpeedEvidence
) -> None:
    """Set which wheels are left out, by what each means for the speed of the car.

    Where nothing is left that could be believed, all of it starts again: the expectation is wrong.
    """
    allowed = p.tolerance + p.share * abs(seen.expected)
    # While nothing brakes, a wheel without a motor rolls.
    rolls = seen.direction * seen.expected >= 0.0
    for i in range(4):
        gap = seen.by_wheel[i] - seen.expected
        # A driven wheel cannot be slower than it rolls, a braked one not faster: the direction is
        # against the travel then.
        is_behind = gap * seen.direction < -allowed
        is_off = rolls and not car.driven[i] and abs(gap) > allowed
        # Asked first and always, because it keeps since when the wheel has its speed.
        cannot_be = is_stuck(p, car, s, seen, i) or is_behind or is_off
        if cannot_be:
            # With a time below a period one look is enough.
            s.doubt[i] = min(s.doubt[i] + period / max(p.time, period), 1.0)
        else:
            s.doubt[i] = max(s.doubt[i] - period / p.recovery, 0.0)
        if s.doubt[i] == 1.0:
            s.lost[i] = 1.0
        elif s.doubt[i] == 0.0:
            s.lost[i] = 0.0
        s.left_out[i] = 1.0 if cannot_be else s.lost[i]
    s.velocity[:] = seen.velocity
    if believed(s) == 0.0 and s.lost[0] + s.lost[1] + s.lost[2] + s.lost[3] == 4.0:
        for i in range(4):
            s.doubt[i] = 0.0
            s.lost[i] = 0.0
            s.left_out[i] = 0.0
            s.gained[i] = 0.0
        s.known = False


@compilable
def is_stuck(
    p: WheelTrustParameters, car: Car, s: WheelTrustState, seen: SpeedEvidence, i: int
) -> bool:
    """Return true if a turning wheel keeps its speed while the car changes its own.

    Both the mean of the other wheels and the accelerometer must show it, each from then until now:
    noise does not add up, and neither wheels that spin nor an accelerometer's offset alone make it.
    """
    velocity = seen.velocity
    others = ((velocity[0] + velocity[1]) + (velocity[2] + velocity[3])) - velocity[i]
    if velocity[i] != s.velocity[i] or velocity[i] == 0.0:
        s.others[i] = others
        s.gained[i] = 0.0
        return False
    s.gained[i] += seen.gained
    change = (others - s.others[i]) / 3.0 * car.wheel_radius
    return min(abs(change), abs(s.gained[i])) > p.tolerance


@compilable
def believed(s: WheelTrustState) -> float:
    """Number of wheels that are not left out [1]."""
    return 4.0 - (s.left_out[0] + s.left_out[1] + s.left_out[2] + s.left_out[3])
