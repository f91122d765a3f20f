"""No traction control."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class OffParameters:
    """Nothing to choose."""


@dataclass(slots=True)
class OffState:
    """Nothing lasts between steps."""


@method("asr", "off")
class Off:
    """Let the requested wheel torques through unchanged."""

    parameters = OffParameters

    def __init__(self, parameters: OffParameters, vehicle: Vehicle, period: float) -> None:
        self.state = OffState()

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        """The same torques [N m]."""
        return WheelTorqueCommand(request.drive, request.brake)
