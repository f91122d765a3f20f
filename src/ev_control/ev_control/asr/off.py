"""No traction control, and none but a limp mode: a lost motor does not turn the car."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.limp_mode import LostMotorParameters, LostMotors, without_yaw
from ev_core.law import Car, WheelStates, WheelTorqueCommand, WheelTorqueRequest, compilable, group, method, part
from ev_core.vehicle.car import each_driven, equal_motors


@method("asr", "off", mirrored=True)
@compilable
def off(request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Let the requested wheel torques through unchanged."""
    return WheelTorqueCommand(request.drive, request.brake)


@dataclass(frozen=True, slots=True)
class LimpHomeParameters:
    """When a motor counts as lost."""

    plausibility: LostMotorParameters = group(LostMotorParameters)


@dataclass(slots=True)
class LimpHomeState:
    """What is known of the motors."""

    motors: LostMotors = part(LostMotors)


@method("asr", "limp_home", needs=(each_driven, equal_motors), mirrored=True)
@compilable
def limp_home(
    p: LimpHomeParameters, car: Car, s: LimpHomeState, period: float, request: WheelTorqueRequest, wheels: WheelStates
) -> WheelTorqueCommand:
    """Let the requested torques through; where a motor is lost, its partner of the axle gives what it gives.

    The car keeps the drive of its other axle, if it has one, and coasts otherwise. With it goes what the difference of
    the two torques did: assistance of the steering, torque vectoring. Brakes are not touched.
    """
    return without_yaw(p.plausibility, car, s.motors, period, request, request.drive, wheels)
