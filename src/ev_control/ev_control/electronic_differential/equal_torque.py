"""An electronic differential that copies an open mechanical one: the same torque on every driven wheel."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import BrakeSplitParameters, split
from ev_core.law import Car, DriverCommand, WheelTorqueRequest, any_driven, compilable, group, method


@dataclass(frozen=True, slots=True)
class EqualTorqueParameters:
    """Only the brakes leave a choice."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "equal_torque", EqualTorqueParameters, needs=(any_driven,), mirrored=True)
@compilable
def equal_torque(p: EqualTorqueParameters, car: Car, driver: DriverCommand) -> WheelTorqueRequest:
    """Give every driven wheel the same share of the drive torque, for any layout."""
    return split(p.brake, car, driver, 0.0)
