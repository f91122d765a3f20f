"""An electronic differential that copies an open mechanical one: the same torque on every driven wheel."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.torque_split import BrakeSplitParameters, split
from ev_core.methods.register import method
from ev_core.parameters.declaration import group
from ev_core.vehicle.car import Car
from ev_core.vehicle.layout import any_driven
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class EqualTorqueParameters:
    """Only the brakes leave a choice."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "equal_torque", EqualTorqueParameters, needs=(any_driven,), mirrored=True)
@compilable
def equal_torque(p: EqualTorqueParameters, car: Car, driver: DriverCommand) -> WheelTorqueRequest:
    """Give every driven wheel the same share of the drive torque, for any layout."""
    return split(p.brake, car, driver, 0.0)
