"""Slip control by PI action, and by fuzzy rules (dissertation, first section 1.4, fig. 1.18)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.law import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    forget_filtered,
    observed_slip,
    traction_control,
)
from ev_control.shared.wheel_regulation import (
    RegulatedWheel,
    SlipRegulatorParameters,
    stays_out,
    until_served,
    weighed,
)
from ev_core.law import Car, compilable, entry, group, parameter, part

# Change of the limit over its largest one; rows: slip below, at, above the target; columns: slip
# falls, stays, rises.
RULES = (
    (0.5, 0.3, 0.1),
    (0.2, 0.0, -0.4),
    (0.0, -0.4, -1.0),
)


@dataclass(frozen=True, slots=True)
class PiSlipParameters:
    """Two poles of the slip; the source gives no gains."""

    natural_frequency: float = parameter(
        20.0, unit="rad/s", low=0.1, high=1000.0, about="natural frequency of the slip"
    )
    damping_ratio: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="damping ratio of the slip"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class PiSlipWheel(RegulatedWheel):
    """State of a wheel."""

    integral: float = entry(unit="N m", about="integral part of the limit")


@traction_control("pi_slip", reference="regulator.reference")
@compilable
def pi_slip(
    p: PiSlipParameters, car: Car, w: PiSlipWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Bring the slip of each wheel to its target by proportional and integral action.

    Limit = J w (2 D w_0 e + w_0^2 integral(e)), e = S* - S, from the torque at which the slip
    exceeded S*. About a point of work the wheel alone gives J w S' = M - M_road, so the gains J w 2
    D w_0 and J w w_0^2 place two poles of the natural frequency w_0; the slope of the tyre's curve,
    which is not linear, is left to them. Behind the peak it pushes them apart, the more the slower
    the wheel turns: with a target there the slip swings at low speed. Dissertation, first section
    1.4: a PI controller for small changes about a point of work. The integral stops at the request.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    if stays_out(p.regulator, w, slip):
        return inf
    slip = weighed(p.regulator, slip, motion)
    if w.limit == inf:
        # It begins at the torque at which the slip exceeded its target.
        w.integral = min(max(motion.torque, 0.0), wanted)
    error = p.regulator.target - slip
    gain = car.driven_wheel_inertia[motion.place] * max(motion.speed, p.regulator.slip.slowest)
    integral_gain = gain * (p.natural_frequency * p.natural_frequency * period)
    w.integral = min(max(w.integral + integral_gain * error, 0.0), wanted)
    torque = w.integral + gain * (2.0 * p.damping_ratio * p.natural_frequency) * error
    return until_served(p.regulator, w, period, torque, wanted)


@dataclass(frozen=True, slots=True)
class FuzzyParameters:
    """Width of the sets and rate of the limit; the source gives no rule and no number."""

    error_width: float = parameter(
        0.08, unit="1", low=1e-3, high=1.0, about="slip over its target that is surely too much"
    )
    rate_width: float = parameter(
        2.0, unit="1/s", low=1e-3, high=100.0, about="rise of the slip that is surely one"
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the rate of the slip"
    )
    largest_rate: float = parameter(
        10.0, unit="1/s", low=0.1, high=1000.0, about="largest change of the limit over itself"
    )
    least_torque: float = parameter(
        50.0, unit="N m", low=1.0, high=1e4, about="limit below which it changes as if it were this"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class FuzzyWheel(RegulatedWheel):
    """State of a wheel."""

    slip: Filtered = part(Filtered)  # [1]; its lag is the rate


@traction_control("fuzzy", reference="regulator.reference")
@compilable
def fuzzy(
    p: FuzzyParameters, car: Car, w: FuzzyWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Move the limit by nine rules about the slip error and the rate of the slip.

    Error and rate, over their widths, each belong to three triangular sets (below, at, above;
    falls, stays, rises) with degrees that add up to one. A rule counts with the product of its two
    degrees; the limit changes by the sum of the rules' (`RULES`) times `largest_rate` times itself,
    which is the weighted mean as in Takagi and Sugeno. The rules take torque away faster than they
    give it back. The dissertation (the first section 1.4) reports fuzzy slip control without a
    rule, so these are an assumption.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    if stays_out(p.regulator, w, slip):
        return inf
    if w.limit == inf:
        # The first step has no rate yet, and starts from the torque that acts.
        last, torque = slip, min(max(motion.torque, 0.0), wanted)
        forget_filtered(w.slip)
    else:
        last, torque = w.slip.value, min(w.limit, wanted)
    # The rate of the filtered slip in this step, not a difference of two noisy ones.
    rate = (slip - last) / (p.filter_time + period)
    follow(w.slip, slip, filter_share(period, p.filter_time))
    error = weighed(p.regulator, slip, motion) - p.regulator.target
    change = change_by_rules(error / p.error_width, rate / p.rate_width)
    torque += p.largest_rate * period * change * max(torque, p.least_torque)
    return until_served(p.regulator, w, period, torque, wanted)


@compilable
def change_by_rules(error: float, rate: float) -> float:
    """Sum of the rules [1], each by the degrees to which its two conditions hold."""
    change = 0.0
    errors = degrees(error)
    rates = degrees(rate)
    for i in range(3):
        for j in range(3):
            change += errors[i] * rates[j] * RULES[i][j]
    return change


@compilable
def degrees(value: float) -> tuple[float, float, float]:
    """Degrees to which a number belongs to the sets about -1, 0 and 1 [1]; they add up to one."""
    value = min(max(value, -1.0), 1.0)
    return max(-value, 0.0), 1.0 - abs(value), max(value, 0.0)
