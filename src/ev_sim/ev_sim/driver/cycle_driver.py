"""What the three drivers of an urban cycle have in common: the cycle, its windows, brakes, and the lane."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from ev_core.law import Car, Need, Vehicle, compilable, entry, group, method, part, speed_along_path
from ev_core.methods.law import named_after
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState, WheelStates
from ev_sim.driver.lane_keeping import LaneKeepingParameters, LaneKeepingState, keep_lane
from ev_sim.driver.path import Path, edge_notes, path_of
from ev_sim.driver.speed_control import SpeedControlParameters, SpeedControlState, follow_speed
from ev_sim.profiles.cycle_windows import TRACTION, CycleModes, CycleModesParameters, cycle_modes, mode_at
from ev_sim.profiles.profile import (
    Profile,
    SpeedProfileParameters,
    value_at,
    wanted_speed,
    with_speed_profile_from_file,
)

D = TypeVar("D", bound=Callable[..., float])


@dataclass(frozen=True, slots=True)
class CycleDriverParameters(LaneKeepingParameters):
    """The cycle, its windows, and how the driver slows down and steers."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    modes: CycleModesParameters = group(CycleModesParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)


@dataclass(slots=True)
class CycleDriverState:
    """What feet and hands remember."""

    speed_control: SpeedControlState = part(SpeedControlState)
    pressed: float = entry(unit="", about="whether the accelerator is pressed, by a foot that knows only that")
    hands: LaneKeepingState = part(LaneKeepingState)


class Cycle(NamedTuple):
    """Speed over time [m/s], windows and path."""

    speed: Profile
    modes: CycleModes
    path: Path


def cycle_of(parameters: CycleDriverParameters, vehicle: Vehicle, period: float) -> Cycle:
    """The cycle that the parameters describe; ParameterError if they name a profile file that has not been read."""
    speed = wanted_speed(parameters.speed_profile)
    return Cycle(speed, cycle_modes(parameters.modes, speed), path_of(parameters.path))


@compilable
def drive_cycle(
    drive_torque: Callable[..., float],
    p: CycleDriverParameters,
    car: Car,
    c: Cycle,
    s: CycleDriverState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    pose: BodyPose,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> DriverCommand:
    """Pedals by the window of the cycle, hand torque by the place of the car beside its path.

    In the traction windows the driver gives `drive_torque`, and in the others just follows the cycle. There a car that
    is to slow down is braked by its drives as far as `speed_control.max_regenerative_torque`, then by its brakes, and
    driven where the road slows it down more than it should (snow does); one that is to stand is held.
    """
    speed = speed_along_path(body)
    hand_torque = keep_lane(p, car, c.path, s.hands, period, now.time, pose, speed, column)
    wanted = value_at(c.speed, now.time)
    if mode_at(c.modes, now.time) == TRACTION:
        return DriverCommand(drive_torque(p, car, s, period, wanted, speed, wheels), 0.0, hand_torque)
    s.pressed = 0.0
    drive, brake = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)
    return DriverCommand(drive, brake, hand_torque)


def notes(p: CycleDriverParameters, s: CycleDriverState) -> tuple[str, ...]:
    """Whether the car has left its road."""
    return edge_notes(s.hands.edge, p.path.width)


def cycle_driver(
    name: str, parameters: type, needs: tuple[Need, ...] = (), requires: Mapping[str, str] = MappingProxyType({})
) -> Callable[[D], D]:
    """Register what a driver does in windows of traction as a driver of the whole cycle, under its docstring.

    It is `(p, car, s, period, wanted, speed, wheels)`, with the wanted and the present speed [m/s], and gives the drive
    torque of all wheels together [N m]; p is a CycleDriverParameters with more.
    """

    def register(drive_torque: D) -> D:
        def driver(
            p: Any,
            car: Car,
            c: Cycle,
            s: CycleDriverState,
            period: float,
            now: Instant,
            body: BodyVelocity,
            pose: BodyPose,
            column: SteeringColumnState,
            wheels: WheelStates,
        ) -> DriverCommand:
            return drive_cycle(drive_torque, p, car, c, s, period, now, body, pose, column, wheels)

        method(
            "driver",
            name,
            parameters,
            state=CycleDriverState,
            prepare=cycle_of,
            load_files=with_speed_profile_from_file,
            notes=notes,
            needs=needs,
            requires=requires,
            mirrored=True,
        )(compilable(named_after(driver, drive_torque)))
        return drive_torque

    return register
