"""No traction control."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.methods.register import method
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import WheelTorqueCommand, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class OffParameters:
    """Nothing to choose."""


@method("asr", "off", OffParameters, mirrored=True)
@compilable
def off(request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Let the requested wheel torques through unchanged."""
    return WheelTorqueCommand(request.drive, request.brake)
