"""The largest torque of a motor over its speed, for the drives that have it and for the laws that count on it."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.motor import Motor

SPEED_FADE = 0.02  # share of the maximum speed over which the drive torque fades; it softens a corner
LEAST_SPEED = 1e-9  # [rad/s], of a power divided by it


@inlined
def speed_fade(maximum: float, turns: float) -> float:
    """Share [1] of the torque that is left near the maximum speed, at a speed of this magnitude [rad/s]."""
    return min(max((maximum - turns) / (SPEED_FADE * maximum), 0.0), 1.0)


@inlined
def driving_torque(motor: Motor, most: float, share: float, turns: float) -> float:
    """Largest torque [N m] at a speed of this magnitude [rad/s], of `most` [N m] and a share of the peak power [1]."""
    return min(most, share * motor.peak_power / max(turns, LEAST_SPEED)) * speed_fade(motor.maximum_speed, turns)


@inlined
def generating_torque(motor: Motor, most: float, share: float, turns: float) -> float:
    """The same of a motor that is driven, with its generator's torque and power; no speed is too much for it."""
    return min(most, motor.generator_torque, share * motor.generator_power / max(turns, LEAST_SPEED))
