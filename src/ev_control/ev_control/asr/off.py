"""No traction control."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import WheelTorqueCommand, WheelTorqueRequest, compilable, method


@dataclass(frozen=True, slots=True)
class OffParameters:
    """Nothing to choose."""


@method("asr", "off", OffParameters, mirrored=True)
@compilable
def off(request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Let the requested wheel torques through unchanged."""
    return WheelTorqueCommand(request.drive, request.brake)
