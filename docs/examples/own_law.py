"""Your own method of the node asr as a function: the law of own_method.py, in plain Python and ready to be compiled."""

from dataclasses import dataclass

from ev_core.law import (
    Wheels,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    method,
    parameter,
)


@dataclass(frozen=True, slots=True)
class LimitParameters:
    """What can be set by --set asr.limit=..., by a parameter file or by `ros2 param set`."""

    limit: float = parameter(
        1000.0, unit="N m", low=0.0, high=10000.0, about="largest drive torque of a wheel"
    )


@method("asr", "limit_in_python", mirrored=True)
def limit_in_python(p: LimitParameters, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Limit the drive torque of every wheel: whatever Python can."""
    return WheelTorqueCommand(
        Wheels(*(min(torque, p.limit) for torque in request.drive)), request.brake
    )


@method("asr", "limit_compiled", mirrored=True)
@compilable
def limit_compiled(p: LimitParameters, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Limit the drive torque of every wheel: the part of Python that offline runs compile."""
    left, right, rear_left, rear_right = request.drive
    drive = Wheels(
        min(left, p.limit), min(right, p.limit), min(rear_left, p.limit), min(rear_right, p.limit)
    )
    return WheelTorqueCommand(drive, request.brake)
