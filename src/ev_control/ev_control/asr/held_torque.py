"""Traction control by the torque of the last step in which the slip was in its range (dissertation, principle 3)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.law import LimitedWheel, ReferenceSpeedParameters, WheelMotion, slip_of, slowest_wheel, traction_control
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.slip_thresholds import SlipThresholdParameters
from ev_core.law import Car, compilable, entry, group


@dataclass(frozen=True, slots=True)
class HeldTorqueParameters(SlipThresholdParameters):
    """The range of the slip."""

    slowest: float = slowest_wheel()
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class HeldTorqueWheel(LimitedWheel):
    """What the law knows of a wheel."""

    held: float = entry(inf, unit="N m", about="torque of the last step in which the slip was not beyond its range")


@traction_control("held_torque", HeldTorqueParameters, HeldTorqueWheel)
@compilable
def held_torque(
    p: HeldTorqueParameters, car: Car, w: HeldTorqueWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Hold the torque of the previous step, when the slip was still in its range, as long as the slip is beyond it.

    M <= M_const where S > 0.19, with the torque at which S last was in 0.15..0.19 (dissertation, section 2.4, principle
    3, eqs 1.5 and 1.6), or below it if the slip leapt over the range. As written: the limit takes nothing back, so
    beyond the peak of the curve the wheel goes on spinning; `slip_window` is what makes a regulation of it.
    """
    if slip_of(motion, p.slowest) > p.high:
        return w.held
    w.held = wanted
    return inf
