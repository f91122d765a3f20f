"""The speed control of a drive: proportional and integral action within the torques that it may use."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import parameter


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """Gains of a drive in speed mode, both assumed: the sources that command speeds give none."""

    gain: float = parameter(
        3.0,
        unit="N m s/rad",
        low=0.0,
        high=1000.0,
        about="proportional gain at the shaft; with the inertia J of wheel and rotor there the speed follows at gain/J",
        source="assumption",
    )
    integral_time: float = parameter(
        1.0,
        unit="s",
        low=1e-3,
        high=1e3,
        about="integral time; shorter ones let the speed of the car swing, whose inertia a rolling wheel carries",
        source="assumption",
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
