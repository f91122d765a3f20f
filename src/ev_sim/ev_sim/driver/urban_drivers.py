"""The drivers of an urban cycle: by speed control, by two pedal positions, by an imposed speed.

How it works: a cycle has windows of traction, of slowing down and of standing. All drivers keep the
lane and follow the speed outside of traction alike; they differ in the torque that they ask for in
traction, which is all that a function under `cycle_driver` gives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from ev_core.law import Need, Vehicle, any_driven, compilable, entry, group, parameter, part
from ev_core.methods.law import named_after
from ev_core.vehicle.car import GRAVITY, Car, speed_along_path
from ev_msgs_py.contract.signals import (
    DriverCommand,
    WheelStates,
)
from ev_sim.driver.followers import (
    LaneKeepingParameters,
    LaneKeepingState,
    OnPath,
    keep_lane,
    road_notes,
)
from ev_sim.driver.path import Path, path_of
from ev_sim.driver.pedals import (
    SpeedControlParameters,
    SpeedControlState,
    driver_method,
    follow_speed,
)
from ev_sim.profiles.cycle_windows import (
    TRACTION,
    CycleModes,
    CycleModesParameters,
    cycle_modes,
    mode_at,
)
from ev_sim.profiles.profile import Profile, SpeedProfileParameters, value_at, wanted_speed

D = TypeVar("D", bound=Callable[..., float])


@dataclass(frozen=True, slots=True)
class CycleDriverParameters(LaneKeepingParameters):
    """The cycle, its windows, and how the driver slows down and steers."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    modes: CycleModesParameters = group(CycleModesParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)


@dataclass(slots=True)
class CycleState:
    """Memory of feet and hands."""

    speed_control: SpeedControlState = part(SpeedControlState)
    pressed: float = entry(
        unit="", about="whether the accelerator is pressed, by a foot that knows only that"
    )
    hands: LaneKeepingState = part(LaneKeepingState)


class Cycle(NamedTuple):
    """Speed over time [m/s], windows and path."""

    speed: Profile
    modes: CycleModes
    path: Path


def cycle_of(parameters: CycleDriverParameters, vehicle: Vehicle, period: float) -> Cycle:
    """The cycle of the parameters; ParameterError if a file that they name has not been read."""
    speed = wanted_speed(parameters.speed_profile)
    return Cycle(speed, cycle_modes(parameters.modes, speed), path_of(parameters.path))


class InCycle(NamedTuple):
    """Signals that the driver of a cycle reads."""

    road: OnPath
    wheels: WheelStates


class Pull(NamedTuple):
    """Wanted and present speed in a window of traction [m/s], and the wheels."""

    wanted: float
    speed: float
    wheels: WheelStates


def cycle_driver(
    name: str,
    parameters: type,
    needs: tuple[Need, ...] = (),
    requires: Mapping[str, str] = MappingProxyType({}),
) -> Callable[[D], D]:
    """Register what a driver does in windows of traction as a driver of the whole cycle.

    It has the docstring of the function. It is `(p, car, s, period, wanted, speed, wheels)`, with
    the wanted and the present speed [m/s], and gives the drive torque of all wheels together [N m];
    p is a CycleDriverParameters with more.

    In the traction windows the driver gives `drive_torque`, and in the others just follows the
    cycle. There a car that is to slow down is braked by its drives as far as
    `speed_control.max_regenerative_torque`, then by its brakes, and driven where the road slows it
    down more than it should (snow does); one that is to stand is held. The hand torque is that of
    the place of the car beside its path.
    """

    def register(drive_torque: D) -> D:
        def driver(
            p: Any, car: Car, c: Cycle, s: CycleState, period: float, seen: InCycle
        ) -> DriverCommand:
            time, speed = seen.road.now.time, speed_along_path(seen.road.body)
            hand_torque = keep_lane(p, car, c.path, s.hands, period, seen.road)
            wanted = value_at(c.speed, time)
            if mode_at(c.modes, time) == TRACTION:
                pull = drive_torque(p, car, s, period, Pull(wanted, speed, seen.wheels))
                return DriverCommand(pull, 0.0, hand_torque)
            # The next window of traction begins with the foot up.
            s.pressed = 0.0
            control = s.speed_control
            drive, brake = follow_speed(p.speed_control, car, control, period, wanted, speed)
            return DriverCommand(drive, brake, hand_torque)

        driver_method(
            name,
            parameters=parameters,
            state=CycleState,
            prepare=cycle_of,
            notes=road_notes,
            needs=needs,
            requires=requires,
        )(compilable(named_after(driver, drive_torque)))
        return drive_torque

    return register


@dataclass(frozen=True, slots=True)
class PowerLevelParameters:
    """Power that the driver asks for; the source has "above the limit of packed snow" alone."""

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
        source="dissertation, table 2.3: that peak",
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
        about="below this speed the level is a torque: a power gives none at rest",
    )


@compilable
def torque_of_power(p: PowerLevelParameters, car: Car, speed: float, wheels: WheelStates) -> float:
    """Drive torque of all wheels together [N m] at a speed of the car [m/s], forwards.

    That of a power P = k (friction + rolling resistance) W V/(1 - slip). W is the load of the
    driven wheels at rest; with k = 1 that is the power at which they all turn at the slip of the
    limit. The torque is P over the mean speed of the driven wheels, so it falls where they spin: a
    drive that is given a power gives just that.
    """
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    driven, velocity = car.driven, wheels.velocity
    share = 0.0
    for i in range(4):
        if driven[i] == 1.0:
            share += (front if i < 2 else 1.0 - front) / 2.0
    # Left and right first, so that a mirrored car gets the same number.
    turning = (driven[0] * velocity[0] + driven[1] * velocity[1]) + (
        driven[2] * velocity[2] + driven[3] * velocity[3]
    )
    load = car.mass * GRAVITY * share
    power = (
        p.factor
        * (p.friction + p.rolling_resistance)
        * load
        # At the slip of the limit wheels turn 1/(1 - slip) times as fast as they would roll.
        / (1.0 - p.slip)
        * max(speed, p.slowest)
    )
    return power / max(turning / car.number_driven, p.slowest / car.wheel_radius)


@cycle_driver("tracking", CycleDriverParameters)
@compilable
def tracking(p: CycleDriverParameters, car: Car, s: CycleState, period: float, pull: Pull) -> float:
    """Follow a speed cycle with just the drive torque that it takes, and keep the lane.

    In windows of traction the foot is on the accelerator or off, never on the brake. This driver
    never asks for more than packed snow carries, so all torque controls come out alike
    (docs/dissertation.md).
    """
    # Behind a window of slowing down the integral is below zero, and would hold the foot off the
    # pedal.
    s.speed_control.integral = max(s.speed_control.integral, 0.0)
    drive, _ = follow_speed(p.speed_control, car, s.speed_control, period, pull.wanted, pull.speed)
    return max(drive, 0.0)


@dataclass(frozen=True, slots=True)
class ImposedSpeedParameters(CycleDriverParameters):
    """The cycle and the power."""

    level: PowerLevelParameters = group(PowerLevelParameters)


@dataclass(frozen=True, slots=True)
class PulseParameters(ImposedSpeedParameters):
    """The same, and when the foot goes down and up."""

    band: float = parameter(
        0.3,
        unit="m/s",
        low=0.0,
        high=10.0,
        about="the foot goes down this far below the cycle, up this far above it",
    )


@cycle_driver("pulse", PulseParameters, needs=(any_driven,))
@compilable
def pulse(p: PulseParameters, car: Car, s: CycleState, period: float, pull: Pull) -> float:
    """Follow a speed cycle with the accelerator released or at a power above packed snow's limit.

    The foot stays where it is within the band around the cycle.
    """
    # A switch with hysteresis: within the band the foot stays.
    if pull.speed <= pull.wanted - p.band:
        s.pressed = 1.0
    elif pull.speed >= pull.wanted + p.band:
        s.pressed = 0.0
    return torque_of_power(p.level, car, pull.speed, pull.wheels) if s.pressed == 1.0 else 0.0


# A free car would run away from a foot that does not know its speed.
@cycle_driver(
    "imposed_speed",
    ImposedSpeedParameters,
    needs=(any_driven,),
    requires={"plant.speed": "imposed"},
)
@compilable
def imposed_speed(
    p: ImposedSpeedParameters, car: Car, s: CycleState, period: float, pull: Pull
) -> float:
    """Ask for a power above the limit of packed snow in windows of traction, at any speed.

    For a plant at an imposed speed (`plant.speed: imposed`), that of the cycle, as on a test bench:
    dissertation, chapter 3, where the driver regulates a power above the limit of packed snow and
    the car yet follows the cycle.
    """
    return torque_of_power(p.level, car, pull.speed, pull.wheels)
