"""Speed set-points by the slip (dissertation, section 2.4, principle 2)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import SlipThresholdParameters, WheelMotion, slip_of, traction_control
from ev_control.shared.speed_mode import SpeedSetPointParameters, SpeedSetPointWheel, moved
from ev_core.law import Car, compilable, group


@dataclass(frozen=True, slots=True)
class SpeedBySlipParameters(SpeedSetPointParameters):
    """The range of the slip, and how the set-point moves."""

    thresholds: SlipThresholdParameters = group(SlipThresholdParameters)


@traction_control("speed_by_slip", SpeedBySlipParameters, SpeedSetPointWheel, speed_mode=True)
@compilable
def speed_by_slip(
    p: SpeedBySlipParameters, car: Car, w: SpeedSetPointWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Lower a wheel's speed set-point while its slip is above 0.15..0.19, raise it while the slip is below.

    Principle 2 of slip control, by the slip itself (dissertation, eq 1.5 and section 2.4): a slip that exceeds the
    range lowers the set-point. The drive is in speed mode. What the text leaves open: where the set-point begins (at
    the speed of the wheel), how fast it falls, and that below the range it rises.
    """
    slip, course = slip_of(motion, p.slowest), 0.0
    if slip > p.thresholds.high:
        course = -1.0
    elif slip < p.thresholds.low:
        course = 1.0
    return moved(p, car, w, period, motion, wanted, course)
