"""Traction control by a range of the slip, or a held torque (dissertation, eqs 1.5, 1.6)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_angle_observer import (
    SideForceParameters,
    SlipAngleObserverState,
    share_left,
)
from ev_control.estimation.wheel_dynamics import share_at_rest
from ev_control.law import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    share_at,
    slip_of,
    slowest_wheel,
)
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.traction_control import LimitedWheel, traction_control
from ev_control.shared.wheel_regulation import SlipThresholdParameters
from ev_core.law import Car, compilable, entry, group, parameter, part


@dataclass(frozen=True, slots=True)
class SlipWindowParameters(SlipThresholdParameters):
    """The window of the source, and how fast the limit moves outside it."""

    fall: float = parameter(
        8000.0, unit="N m/s", low=1.0, high=1e6, about="fall of the limit above the window"
    )
    rise: float = parameter(
        2000.0, unit="N m/s", low=1.0, high=1e6, about="rise of the limit below the window"
    )
    trend: float = parameter(
        0.02,
        unit="s",
        low=0.0,
        high=1.0,
        about="time over which the slip shows whether it is returning to the window",
    )
    slowest: float = slowest_wheel()
    at_rest: float = share_at_rest(0.5)  # with less its limit swings more on ice, which costs speed
    side_force: SideForceParameters = group(SideForceParameters)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class SlipWindowWheel(LimitedWheel):
    """State of a wheel."""

    slip: Filtered = part(Filtered)  # [1]; its lag shows the trend
    side_force: SlipAngleObserverState = part(SlipAngleObserverState)


@traction_control("slip_window")
@compilable
def slip_window(
    p: SlipWindowParameters,
    car: Car,
    w: SlipWindowWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's torque limit above a slip of 0.15..0.19, hold it inside, raise it below.

    Slip S = 1 - w_free/w (dissertation, eqs 1.5, 1.6 and 2.34). The source prints the window as
    "0.15 > S > 0.19", which no slip satisfies; its section 2.4 explains it. The first limit is the
    torque at which the slip leaves the window (eq 1.6). Where the slip is already returning the
    limit stays, else it would overshoot by the time that the wheel takes (assumption). The window
    lies beyond the peak on snow (0.09) and wet asphalt (0.13), where a wheel does not stay by
    itself: the slip swings through the window. With `side_force.correction` both ends shrink with
    the slip angle (section 1.4).
    """
    slip = slip_of(motion, p.slowest)
    left = share_left(p.side_force, car, w.side_force, period, motion)
    left *= share_at(motion, p.slowest, p.at_rest)
    low, high = left * p.low, left * p.high
    # A slip that returns by itself is left alone, else the limit would overshoot.
    rises = slip > follow(w.slip, slip, filter_share(period, p.trend))
    # It begins at the torque that acts, which may be less than what is wanted.
    if slip > high and w.limit == inf:
        return min(wanted, max(motion.torque, 0.0))
    if slip > high and rises:
        return w.limit - p.fall * period
    if slip < low and not rises:
        raised = w.limit + p.rise * period
        return raised if raised < wanted else inf
    return w.limit


@dataclass(frozen=True, slots=True)
class HeldTorqueParameters(SlipThresholdParameters):
    """The range of the slip."""

    slowest: float = slowest_wheel()
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class HeldTorqueWheel(LimitedWheel):
    """State of a wheel."""

    held: float = entry(
        inf, unit="N m", about="torque of the last step in which the slip was not beyond its range"
    )


@traction_control("held_torque")
@compilable
def held_torque(
    p: HeldTorqueParameters,
    car: Car,
    w: HeldTorqueWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Hold the last torque with a slip in its range as long as the slip is beyond it.

    M <= M_const where S > 0.19, with the torque at which S last was in 0.15..0.19 (dissertation,
    section 2.4, principle 3, eqs 1.5 and 1.6), or below it if the slip leapt over the range. As
    written: the limit takes nothing back, so beyond the peak of the curve the wheel goes on
    spinning; `slip_window` is what makes a regulation of it.
    """
    if slip_of(motion, p.slowest) > p.high:
        return w.held
    w.held = wanted
    return inf
