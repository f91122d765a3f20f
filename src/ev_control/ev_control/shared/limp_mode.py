"""What a control of the wheels does where a motor does not give what it is told: its partner gives the same."""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from ev_control.shared.torque_plausibility import (
    PlausibilityParameters,
    PlausibilityState,
    expect,
    mirrored,
    watch_torques,
)
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.layout import Need, each_driven, equal_motors


@dataclass(frozen=True, slots=True)
class LimpModeParameters:
    """Whether lost motors are looked for, and when a motor counts as one."""

    watch: bool = parameter(False, about="whether a lost motor is found by its torque, and its partner mirrors it")
    plausibility: PlausibilityParameters = group(PlausibilityParameters)


def limp_mode_for(group: str) -> Need:
    """The limp mode whose parameters are this group compares wheels that have equal motors of their own."""

    def lacks(parameters: Any, vehicle: Vehicle) -> str:
        if not attrgetter(group)(parameters).watch:
            return ""
        lacking = each_driven(parameters, vehicle) or equal_motors(parameters, vehicle)
        return f"{lacking} for {group}.watch" if lacking else ""

    return lacks


@compilable
def without_yaw(
    p: PlausibilityParameters,
    car: Car,
    s: PlausibilityState,
    period: float,
    drive: Wheels,
    brake: Wheels,
    wheels: WheelStates,
) -> WheelTorqueCommand:
    """The command [N m]; where a motor is lost, its partner of the axle gives what it gives."""
    watch_torques(p, car, s, period, wheels)
    command = WheelTorqueCommand(mirrored(p, s, drive, wheels), brake)
    expect(p, car, s, period, command, wheels)
    return command
