"""Whether a circuit measures what can be: the transducer against the inverter, and against the wheel it stands for."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.inverter_gateway.state import Device
from ev_core.law import compilable, parameter, setting


@dataclass(frozen=True, slots=True)
class PlausibilityParameters:
    """How far apart two measurements of the same may be, and how long."""

    torque: float = parameter(
        30.0, unit="N m", low=1.0, high=1000.0, source="assumption: above what swings and is noise",
        about="at the shaft, between transducer and inverter",
    )  # fmt: skip
    speed: float = parameter(
        30.0, unit="rad/s", low=1.0, high=1000.0, source="assumption: above what the load machine lags behind",
        about="of the shaft, between transducer and the virtual car's wheel",
    )  # fmt: skip
    time: float = setting(0.01, unit="s", low=0.001, high=1.0, about="for longer than this: fault of that drive")


@compilable
def watch(
    p: PlausibilityParameters, s: Device, rotor: float, torque: float, speed: float, wheel: float, period: float
) -> None:
    """Note for how long torque [N m] and speed [rad/s] of the transducer have been far from inverter and wheel.

    The transducer sits behind the rotor [kg m^2], and shows the mean of a period, as what was heard in it is averaged.
    It is latched while the drive is to be enabled, and before that keeps it from being enabled.
    """
    f = s.feedback
    said = f.torque_sum / f.torque_count if f.torque_count > 0.0 else f.torque
    # Until it is enabled, a shaft that the load machine still brings to its speed is in doubt, too.
    inside = torque + (rotor * (speed - s.watched_speed) / period if s.enable != 0.0 else 0.0)
    f.torque_sum, f.torque_count, s.watched_speed = 0.0, 0.0, speed
    apart = abs(inside - said) > p.torque or abs(speed - wheel) > p.speed
    s.doubtful_time = s.doubtful_time + period if apart else 0.0
    if s.enable != 0.0 and s.doubtful_time >= p.time - 0.5 * period:
        s.implausible = 1.0
