"""An electronic differential that copies an open mechanical one: the same torque on every driven wheel."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import DriverCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class EqualTorqueParameters:
    """Only the brakes leave a choice."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "equal_torque")
class EqualTorque:
    """Give every driven wheel the same share of the drive torque, for any layout.

    ValueError if the vehicle has no driven wheel.
    """

    parameters = EqualTorqueParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: EqualTorqueParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)

    def step(self, driver: DriverCommand) -> WheelTorqueRequest:
        """Equal wheel torques [N m]."""
        return self._split.request(driver)
