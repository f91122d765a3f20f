"""The three drivers of an urban cycle: one who follows it, one with two pedal positions, one with an imposed speed."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import GRAVITY, Car, WheelStates, any_driven, compilable, group, parameter
from ev_sim.driver.cycle_driver import CycleDriverParameters, CycleDriverState, cycle_driver
from ev_sim.driver.speed_control import follow_speed


@dataclass(frozen=True, slots=True)
class PowerLevelParameters:
    """How much the driver asks for; the source says no more than above the limit of packed snow."""

    factor: float = parameter(
        1.11,
        unit="1",
        low=0.0,
        high=10.0,
        about="power over that of the limit, k",
        source="fitted on method 2 alone (docs/dissertation.md)",
    )
    friction: float = parameter(
        0.4022,
        unit="1",
        low=0.0,
        high=2.0,
        about="friction of the limit",
        source="dissertation, table 2.3: peak of packed snow 1",
    )
    slip: float = parameter(
        0.0907,
        unit="1",
        low=0.0,
        high=0.9,
        about="slip at the limit",
        source="dissertation, table 2.3: slip of that peak",
    )
    rolling_resistance: float = parameter(
        0.083,
        unit="1",
        low=0.0,
        high=0.5,
        about="rolling resistance that a wheel overcomes before it slips",
        source="dissertation, table 2.2: packed snow, middle of its range, and f_0 of the vehicle",
    )
    slowest: float = parameter(
        1.0,
        unit="m/s",
        low=0.01,
        high=10.0,
        about="below this speed the level is a torque, for a power gives none at rest",
    )


@compilable
def torque_of_power(p: PowerLevelParameters, car: Car, speed: float, wheels: WheelStates) -> float:
    """Drive torque of all wheels together [N m] at a speed of the car [m/s], forwards.

    That of a power P = k (friction + rolling resistance) W V/(1 - slip). W is the load of the driven wheels at rest;
    with k = 1 that is the power at which they all turn at the slip of the limit. The torque is P over the mean speed of
    the driven wheels, so it falls where they spin: a drive that is told a power gives just that.
    """
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    driven, velocity = car.driven, wheels.velocity
    share = 0.0
    for i in range(4):
        if driven[i] == 1.0:
            share += (front if i < 2 else 1.0 - front) / 2.0
    # Left and right first, so that a mirrored car gets the same number.
    turning = (driven[0] * velocity[0] + driven[1] * velocity[1]) + (driven[2] * velocity[2] + driven[3] * velocity[3])
    load = car.mass * GRAVITY * share
    power = p.factor * (p.friction + p.rolling_resistance) * load / (1.0 - p.slip) * max(speed, p.slowest)
    return power / max(turning / car.number_driven, p.slowest / car.wheel_radius)


@cycle_driver("tracking", CycleDriverParameters)
@compilable
def tracking(
    p: CycleDriverParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """Follow a speed cycle with just the drive torque that it takes, and keep the lane.

    In windows of traction the foot is on the accelerator or off, never on the brake. This driver never asks for more
    than packed snow carries, so all torque controls come out alike (docs/dissertation.md).
    """
    s.speed_control.integral = max(s.speed_control.integral, 0.0)
    drive, _ = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)
    return max(drive, 0.0)


@dataclass(frozen=True, slots=True)
class PulseParameters(CycleDriverParameters):
    """The cycle, the power, and when the foot goes down and up."""

    level: PowerLevelParameters = group(PowerLevelParameters)
    band: float = parameter(
        0.3,
        unit="m/s",
        low=0.0,
        high=10.0,
        about="the foot goes down this far below the cycle and up this far above it",
    )


@cycle_driver("pulse", PulseParameters, needs=(any_driven,))
@compilable
def pulse(
    p: PulseParameters, car: Car, s: CycleDriverState, period: float, wanted: float, speed: float, wheels: WheelStates
) -> float:
    """Follow a speed cycle with an accelerator that is either released or at a power above the limit of packed snow.

    The foot stays where it is within the band around the cycle.
    """
    if speed <= wanted - p.band:
        s.pressed = 1.0
    elif speed >= wanted + p.band:
        s.pressed = 0.0
    return torque_of_power(p.level, car, speed, wheels) if s.pressed == 1.0 else 0.0


@dataclass(frozen=True, slots=True)
class ImposedSpeedParameters(CycleDriverParameters):
    """The cycle and the power."""

    level: PowerLevelParameters = group(PowerLevelParameters)


# A free car would run away from a foot that does not know its speed.
@cycle_driver("imposed_speed", ImposedSpeedParameters, needs=(any_driven,), requires={"plant.speed": "imposed"})
@compilable
def imposed_speed(
    p: ImposedSpeedParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """Ask for a power above the limit of packed snow in all windows of traction, whatever the speed.

    For a plant whose speed the cycle imposes (`plant.speed: imposed`), as a test bench does: dissertation, chapter 3,
    where the driver regulates a power above the limit of packed snow and the car yet follows the cycle.
    """
    return torque_of_power(p.level, car, speed, wheels)
