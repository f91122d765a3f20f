"""A motor whose inverter controls its torque: limits and lag."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.motor import Motor
from ev_msgs_py.vehicle.torque_envelope import driving_torque, generating_torque

# Overshoot of the thermal state over which the peak torque shrinks to the nominal one; it softens a corner.
HEAT_FADE = 0.1


@inlined
def limited_torque(motor: Motor, wanted: float, speed: float, heat: float) -> float:
    """The torque [N m] that the inverter goes for when `wanted` [N m] is asked at a shaft speed [rad/s].

    Driving: peak torque (nominal once `heat`, the filtered squared torque over its nominal value [1], is above 1),
    peak power, none beyond the maximum speed. Generating: generator torque and power. At rest both agree on the
    torque limits, so the direction of travel needs no case.
    """
    magnitude = abs(wanted)
    turns = abs(speed)
    hot = min(max((heat - 1.0) / HEAT_FADE, 0.0), 1.0)
    lasting = min(motor.nominal_torque, motor.peak_torque)
    torque_limit = motor.peak_torque + hot * (lasting - motor.peak_torque)
    if wanted * speed >= 0.0:
        limit = driving_torque(motor, torque_limit, 1.0, turns)
    else:
        limit = generating_torque(motor, torque_limit, 1.0, turns)
    limited = min(magnitude, limit)
    return limited if wanted >= 0.0 else -limited
