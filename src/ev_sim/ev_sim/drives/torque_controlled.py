"""A motor whose inverter controls its torque: limits and lag."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

# Overshoot of the thermal state over which the peak torque shrinks to the nominal one, and share of the maximum speed
# over which the drive torque fades: both only soften a corner.
HEAT_FADE = 0.1
SPEED_FADE = 0.02


@compilable
def limited_torque(
    wanted: float,
    speed: float,
    heat: float,
    peak_torque: float,
    nominal_torque: float,
    peak_power: float,
    maximum_speed: float,
    generator_torque: float,
    generator_power: float,
) -> float:
    """The torque [N m] that the inverter goes for when `wanted` [N m] is asked at a shaft speed [rad/s].

    Driving: peak torque (nominal once `heat`, the filtered squared torque over its nominal value [1], is above 1),
    peak power, none beyond the maximum speed. Generating: generator torque and power. At rest both agree on the
    torque limits, so the direction of travel needs no case.
    """
    magnitude = abs(wanted)
    turns = abs(speed)
    hot = min(max((heat - 1.0) / HEAT_FADE, 0.0), 1.0)
    torque_limit = peak_torque + hot * (min(nominal_torque, peak_torque) - peak_torque)
    if wanted * speed >= 0.0:
        fade = min(max((maximum_speed - turns) / (SPEED_FADE * maximum_speed), 0.0), 1.0)
        limit = min(torque_limit, peak_power / max(turns, 1e-9)) * fade
    else:
        limit = min(torque_limit, generator_torque, generator_power / max(turns, 1e-9))
    limited = min(magnitude, limit)
    return limited if wanted >= 0.0 else -limited
