"""Speed set-points by the ratio of the car's to the wheel's acceleration (dissertation, section 2.4, principle 1)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import SpeedSetPointParameters, SpeedSetPointWheel, WheelMotion, moved
from ev_control.shared.acceleration_criterion import (
    AccelerationCriterionParameters,
    Accelerations,
    gains_on_car,
)
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, compilable, group, part


@dataclass(frozen=True, slots=True)
class SpeedByAccelerationRatioParameters(SpeedSetPointParameters):
    """The ratio that tells slip from grip, and how the set-point moves."""

    criterion: AccelerationCriterionParameters = group(AccelerationCriterionParameters)


@dataclass(slots=True)
class SpeedByAccelerationRatioWheel(SpeedSetPointWheel):
    """What the law knows of a wheel."""

    accelerations: Accelerations = part(Accelerations)


@traction_control(
    "speed_by_acceleration_ratio",
    SpeedByAccelerationRatioParameters,
    SpeedByAccelerationRatioWheel,
    speed_mode=True,
)
@compilable
def speed_by_acceleration_ratio(
    p: SpeedByAccelerationRatioParameters,
    car: Car,
    w: SpeedByAccelerationRatioWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's speed set-point while the wheel accelerates out of proportion to the car, a_x/w' < threshold.

    Principle 1 of slip control, by forecast (dissertation, eq 1.4 and section 2.4; the threshold as in
    `acceleration_ratio`). The drive is in speed mode. What the text leaves open: where the set-point begins (at the
    speed of the wheel), how fast it falls, and that it rises while the criterion does not hold.
    """
    gains = gains_on_car(p.criterion, car, w.accelerations, period, motion)
    return moved(p, car, w, period, motion, wanted, -1.0 if gains else 1.0)
