"""Traction control by the ratio of the car's to the wheel's acceleration (dissertation, eq 1.4)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.law import LimitedWheel, LimpModeParameters, ReferenceSpeedParameters, WheelMotion, traction_control
from ev_control.shared.acceleration_criterion import (
    AccelerationCriterionParameters,
    Accelerations,
    gains_on_car,
)
from ev_core.law import Car, compilable, group, parameter, part


@dataclass(frozen=True, slots=True)
class AccelerationRatioParameters(AccelerationCriterionParameters):
    """The ratio that tells slip from grip, and how the limit moves."""

    fall: float = parameter(8000.0, unit="N m/s", low=1.0, high=1e6, about="fall of the limit while the wheel slips")
    rise: float = parameter(500.0, unit="N m/s", low=1.0, high=1e6, about="rise of the limit while it grips")
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class AccelerationRatioWheel(LimitedWheel):
    """What the law knows of a wheel."""

    accelerations: Accelerations = part(Accelerations)


@traction_control("acceleration_ratio", AccelerationRatioParameters, AccelerationRatioWheel)
@compilable
def acceleration_ratio(
    p: AccelerationRatioParameters,
    car: Car,
    w: AccelerationRatioWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's torque limit while the wheel accelerates out of proportion to the car, a_x/w' < threshold.

    A rolling wheel has a_x/w' = r, a slipping one less (dissertation, eq 1.4). The source wants to intervene where
    the ratio exceeds 0.4 m, which for its wheel of 0.32 m never happens, and prints a_x/w' < 0.4, which is always
    true; the sign of eq 1.4 is right, the value is not. The ratio is compared without dividing, only while the
    wheel accelerates more than noise does, and once it has gained more on the car than a tyre that grips. It sees slip
    that grows, not slip: a wheel that spins at a steady speed is left to spin, and the slip that built up before the
    limit fell stays.
    """
    if gains_on_car(p, car, w.accelerations, period, motion):
        return min(w.limit, wanted) - p.fall * period
    raised = w.limit + p.rise * period
    return raised if raised < wanted else inf
