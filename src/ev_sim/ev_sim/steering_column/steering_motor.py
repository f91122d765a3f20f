"""An electric motor that steers: torque and speed limits, lag, gear and losses."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry
from ev_msgs_py.elementary import expm1
from ev_msgs_py.parameters.declaration import parameter

_FADE = 0.1  # of the largest speed, over which the torque in the direction of motion fades


@dataclass(frozen=True, slots=True)
class SteeringMotorParameters:
    """A motor with its inverter and gear; all of it is assumed, as of a column or rack motor of a small car."""

    gear_ratio: float = parameter(200.0, unit="1", low=1.0, high=1e4, about="turns of the shaft per turn of the output")
    peak_torque: float = parameter(5.0, unit="N m", low=0.0, high=1e3, about="at the shaft")
    maximum_speed: float = parameter(300.0, unit="rad/s", low=1.0, high=1e4, about="of the shaft; no torque beyond")
    torque_lag: float = parameter(0.005, unit="s", low=1e-4, high=1.0, about="time constant of the torque control")
    copper_loss: float = parameter(4.0, unit="W/(N m)^2", low=0.0, high=1e4, about="loss per squared shaft torque")
    idle_loss: float = parameter(3.0, unit="W", low=0.0, high=1e3, about="loss without torque")


@dataclass(slots=True)
class SteeringMotorState:
    """Torque at the output, left positive, and where the energy has gone."""

    torque: float = entry(unit="N m", about="at the output, mean of the last period")
    following: float = entry(unit="N m", about="at the output, behind the lag, now")
    work: float = entry(unit="J", about="given to the output")
    loss: float = entry(unit="J", about="in motor and inverter")


@compilable
def steer_by_motor(
    p: SteeringMotorParameters, s: SteeringMotorState, wanted: float, rate: float, period: float
) -> float:
    """The mean torque at the output over a period [N m], of what is wanted there, at a rate of the output [rad/s]."""
    most = p.peak_torque * p.gear_ratio
    limited = min(max(wanted, -most), most)
    if limited * rate > 0.0:
        left = (p.maximum_speed - abs(rate) * p.gear_ratio) / (_FADE * p.maximum_speed)
        limited *= min(max(left, 0.0), 1.0)
    share = -expm1(-period / p.torque_lag)
    gap = limited - s.following
    s.torque = s.following + (1.0 - share * p.torque_lag / period) * gap
    s.following += share * gap
    shaft = s.torque / p.gear_ratio
    s.loss += (p.copper_loss * (shaft * shaft) + p.idle_loss) * period
    return s.torque


@compilable
def book_work(s: SteeringMotorState, before: float, after: float) -> None:
    """Count what the output took from one angle to the other [rad] under the torque of the period."""
    s.work += s.torque * (after - before)
