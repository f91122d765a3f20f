"""No traction control."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class OffParameters:
    """Nothing to choose."""


@method("asr", "off")
class Off:
    """Let the requested wheel torques through unchanged."""

    parameters = OffParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: OffParameters, vehicle: Vehicle, period: float) -> None:
        pass

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        """The same torques [N m]."""
        return WheelTorqueCommand(request.drive, request.brake)
