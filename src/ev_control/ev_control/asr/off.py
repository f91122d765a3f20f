"""No traction control, and none but a limp mode: a lost motor does not turn the car."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.limp_mode import Limited, LostMotorParameters, LostMotors, without_yaw
from ev_core.law import (
    Car,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    group,
    method,
    part,
)
from ev_core.vehicle.car import each_driven, equal_motors


@method("asr", "off", mirrored=True)
@compilable
def off(request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Let the requested wheel torques through unchanged."""
    return WheelTorqueCommand(request.drive, request.brake)


@dataclass(frozen=True, slots=True)
class LimpHomeParameters:
    """Limits beyond which a motor counts as lost."""

    plausibility: LostMotorParameters = group(LostMotorParameters)


@dataclass(slots=True)
class LimpHomeState:
    """State of the motors."""

    motors: LostMotors = part(LostMotors)


@method("asr", "limp_home", needs=(each_driven, equal_motors), mirrored=True)
@compilable
def limp_home(
    p: LimpHomeParameters,
    car: Car,
    s: LimpHomeState,
    period: float,
    request: WheelTorqueRequest,
    wheels: WheelStates,
) -> WheelTorqueCommand:
    """Pass the requested torques; the partner of a lost motor gives what that one gives.

    The car keeps the drive of its other axle, if it has one, and coasts otherwise. With it goes
    what the difference of the two torques did: assistance of the steering, torque vectoring. Brakes
    are not touched.
    """
    asked = Limited(request, request.drive, wheels)
    return without_yaw(p.plausibility, car, s.motors, period, asked)
