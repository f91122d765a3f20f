"""Integral part of a yaw moment, which follows what motors and tyres leave (anti-windup)."""

from dataclasses import dataclass

from ev_control.estimation.wheel_dynamics import filter_share
from ev_core.law import compilable, entry


@dataclass(slots=True)
class MomentIntegral:
    """State of a controller that integrates."""

    moment: float = entry(unit="N m", about="integral part of the yaw moment")


@compilable
def follow_saturation(
    s: MomentIntegral, period: float, tracking_time: float, missing: float
) -> None:
    """Take back what is missing of the moment [N m] (Astrom & Murray 2008, 10.4)."""
    s.moment -= filter_share(period, tracking_time) * missing
