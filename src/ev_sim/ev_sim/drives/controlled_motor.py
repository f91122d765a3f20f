"""A motor whose inverter controls its torque, with limits and lag, or its speed within them."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import compilable, inlined, parameter
from ev_core.vehicle.motor import Motor, driving_torque, generating_torque

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


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """Gains of a drive in speed mode, both assumed: the sources that command speeds give none."""

    gain: float = parameter(
        3.0,
        unit="N m s/rad",
        low=0.0,
        high=1000.0,
        about="proportional gain at the shaft; with the inertia J of wheel and rotor there the speed follows at gain/J",
    )
    integral_time: float = parameter(
        1.0,
        unit="s",
        low=1e-3,
        high=1e3,
        about="integral time; shorter ones let the speed of the car swing, whose inertia a rolling wheel carries",
    )


@compilable
def speed_control(
    gain: float, integral_time: float, integral: float, error: float, period: float, least: float, most: float
) -> tuple[float, float]:
    """The torque that is asked for [N m], not limited, and its integral part, which stays within `least..most` [N m].

    `error` is the set-point less the speed [rad/s], held over the period [s].
    """
    integral = min(max(integral + gain * error * period / integral_time, least), most)
    return gain * error + integral, integral


@compilable
def speed_control_without_windup(
    gain: float, integral_time: float, integral: float, error: float, period: float, least: float, most: float
) -> tuple[float, float]:
    """The same, and the integral holds where the torque is limited already and would be more so.

    Conditional integration (Astrom and Murray, Feedback Systems, section on integral windup): a drive waits at its
    limit for as long as the car takes to gain speed. A load machine of the bench is there for some milliseconds only.
    """
    held = min(max(integral, least), most)
    asked, moved = speed_control(gain, integral_time, integral, error, period, least, most)
    if (asked > most and moved > held) or (asked < least and moved < held):
        return gain * error + held, held
    return asked, moved
