"""Bounds of observations: by channel a limit of car, motors, tyres or driver, and its reason."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fnmatch import fnmatchcase
from typing import NamedTuple

from ev_core.lockstep.configuration import Configuration
from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import drive_train_numbers, motors_behind
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.drives.drive import DRIVE_MODELS

# [N m], what two hands do in an emergency; drivers of the scenarios stay below
LARGEST_HAND_TORQUE = 20.0
LARGEST_HAND_RATE = 40.0  # [rad/s] of the steering wheel, twice what hands do in an emergency
LARGEST_SPEED = 120.0  # [m/s], that a scenario may begin with
LARGEST_YAW_RATE = 10.0  # [rad/s], 1.6 turns in a second
LARGEST_FRICTION = 2.0  # [1]


class Limit(NamedTuple):
    """The largest magnitude of a channel, in its unit, and what limits it."""

    largest: float
    reason: str


class _Episode(NamedTuple):
    """The car, its longest drive [s], its first frame, and the limits that follow from it.

    Largest `torque` [N m] and `spin` [rad/s] of a wheel, `shaft` speed of a motor [rad/s], `power`
    of all drives [W].
    """

    car: Vehicle
    duration: float
    start: Mapping[str, float]
    torque: float
    spin: float
    shaft: float
    power: float


def motor_torques(plant: Configuration) -> tuple[float, float]:
    """Largest torques at the shaft of a motor, braking and driving [N m], as the plant has them."""
    values = plant.values()
    # A plant with a model of the drive takes its limit from there, not from the vehicle.
    if values.get("drive") in DRIVE_MODELS:
        return values["motor.torque_limit"], values["motor.torque_limit"]
    motor = plant.common.vehicle.motor
    return motor.generator_torque, motor.peak_torque


def _episode(
    car: Vehicle, duration: float, start: Mapping[str, float], motor_torque: float
) -> _Episode:
    gears = drive_train_numbers(car)["gear"]
    motors = max(
        motors_behind(car, wheel) * gear for wheel, gear in zip(WHEEL_NAMES, gears, strict=True)
    )
    by_motor = motors * motor_torque
    # The whole weight on one wheel, which bounds every load transfer.
    by_tyre = LARGEST_FRICTION * car.mass * GRAVITY * car.wheel_radius
    # The smallest wheel turns fastest.
    rolling = LARGEST_SPEED / (car.wheel_radius * min(car.wheel_radius_ratio))
    spin = max(rolling, car.motor.maximum_speed / min(gears))
    power = (
        len(car.driven_wheels) * max(car.motor.peak_power, car.motor.generator_power)
        + car.engine.peak_power
    )
    torque = max(by_motor, by_tyre, car.maximum_brake_torque)
    return _Episode(car, duration, start, torque, spin, spin * max(1.0, *gears), power)


_Rules = tuple[tuple[str, str, Callable[[_Episode], float]], ...]

# Of these patterns the first one counts that a channel fits.
_OF_CHANNELS: _Rules = (
    ("*.hand_torque", "two hands in an emergency", lambda of: LARGEST_HAND_TORQUE),
    ("driver.command.*", "all wheels at their largest torque", lambda of: 4.0 * of.torque),
    (
        "steering_column.state.angle",
        "front wheels at their stop",
        lambda of: _stop(of) * of.car.steering_ratio,
    ),
    ("steering_column.state.rate", "hands in an emergency", lambda of: LARGEST_HAND_RATE),
    ("*.road_wheel_angle", "front wheels at their stop", lambda of: _stop(of)),
    (
        "*.road_wheel_rate",
        "hands in an emergency",
        lambda of: LARGEST_HAND_RATE / of.car.steering_ratio,
    ),
    ("*.yaw_rate", "1.6 turns in a second", lambda of: LARGEST_YAW_RATE),
    (
        "wheel_states.position.*",
        "a wheel at its largest speed all the time",
        lambda of: of.spin * of.duration,
    ),
    (
        "wheel_states.velocity.*",
        "the motor's largest speed, or rolling at 120 m/s",
        lambda of: of.spin,
    ),
    ("pose.orientation_*", "a sine or cosine", lambda of: 1.0),
    ("imu.roll.orientation_*", "a sine or cosine", lambda of: 1.0),
    ("imu.roll.rate", "1.6 turns in a second", lambda of: LARGEST_YAW_RATE),
    ("battery.state_of_charge", "a full battery", lambda of: 1.0),
    ("tire_forces.slip_ratio.*", "a wheel that turns against the way of the car", lambda of: 2.0),
    (
        "tire_forces.friction_coefficient.*",
        "racing tyres on dry asphalt",
        lambda of: LARGEST_FRICTION,
    ),
)

_OF_UNITS: dict[str, tuple[str, Callable[[_Episode], float]]] = {
    "N m": (
        "motors, friction brake or tyre of a wheel, whichever gives most",
        lambda of: of.torque,
    ),
    "rad/s": ("the shaft of a motor at the largest speed of its wheel", lambda of: of.shaft),
    "rad": ("half a turn", lambda of: math.pi),
    "m": ("120 m/s all the time", lambda of: LARGEST_SPEED * of.duration + _far(of.start)),
    "m/s": ("the largest speed that a scenario may begin with", lambda of: LARGEST_SPEED),
    "m/s^2": ("racing tyres on dry asphalt", lambda of: LARGEST_FRICTION * GRAVITY),
    "N": (
        "the whole weight on one racing tyre",
        lambda of: LARGEST_FRICTION * of.car.mass * GRAVITY,
    ),
    "W": ("all drives at their largest power", lambda of: of.power),
    "J": ("all drives at their largest power all the time", lambda of: of.power * of.duration),
    "V": ("voltage class B of ISO 6469-3", lambda of: 1500.0),
    "A": ("the largest current that a motor can be declared with", lambda of: 1e4),
    "A h": ("a full battery", lambda of: of.car.battery.capacity),
    "degC": ("no insulation of a winding lasts beyond", lambda of: 300.0),
    "l/min": ("the largest flow of coolant that can be declared", lambda of: 31.0),
    "s": ("the whole episode", lambda of: of.duration),
    "1": ("a word of 32 bits", lambda of: 2.0**32),
}


def _stop(of: _Episode) -> float:
    return of.car.maximum_road_wheel_angle


def _far(start: Mapping[str, float]) -> float:
    return max(abs(start.get(f"pose.{axis}", 0.0)) for axis in "xy")


def limits(
    channels: tuple[str, ...],
    car: Vehicle,
    duration: float,
    start: Mapping[str, float],
    motor_torque: float,
) -> dict[str, Limit]:
    """Bounds of some channels in an episode of at most `duration` [s] that begins with a frame.

    `motor_torque` is the largest one at the shaft of a motor [N m].
    """
    of, units = _episode(car, duration, start, motor_torque), frame.units()
    found = {}
    for channel in channels:
        rules = (
            (reason, largest)
            for pattern, reason, largest in _OF_CHANNELS
            if fnmatchcase(channel, pattern)
        )
        # The first pattern that fits, else the rule of the unit.
        reason, largest = next(rules, _OF_UNITS[units[channel]])
        found[channel] = Limit(largest(of), reason)
    return found
