"""Slip control by proportional and integral action (dissertation, section 1.3, figure 1.18)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.slip_observers import observed_slip
from ev_control.estimation.wheel_dynamics import WheelMotion
from ev_control.law import RegulatedWheel, SlipRegulatorParameters, stays_out, until_served, weighed
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, compilable, entry, group, parameter


@dataclass(frozen=True, slots=True)
class PiSlipParameters:
    """Where the two poles of the slip lie; the source gives no gains."""

    natural_frequency: float = parameter(
        20.0, unit="rad/s", low=0.1, high=1000.0, about="natural frequency of the slip"
    )
    damping_ratio: float = parameter(1.0, unit="1", low=0.1, high=10.0, about="damping ratio of the slip")
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class PiSlipWheel(RegulatedWheel):
    """What the law knows of a wheel."""

    integral: float = entry(unit="N m", about="integral part of the limit")


@traction_control("pi_slip", PiSlipParameters, PiSlipWheel, reference="regulator.reference")
@compilable
def pi_slip(p: PiSlipParameters, car: Car, w: PiSlipWheel, period: float, motion: WheelMotion, wanted: float) -> float:
    """Bring the slip of each wheel to its target by proportional and integral action.

    Limit = J w (2 D w_0 e + w_0^2 integral(e)), e = S* - S, from the torque at which the slip exceeded S*. About a
    point of work the wheel alone gives J w S' = M - M_road, so the gains J w 2 D w_0 and J w w_0^2 place two poles of
    the natural frequency w_0; the slope of the tyre's curve, which is not linear, is left to them. Behind the peak it
    pushes them apart, the more the slower the wheel turns: with a target there the slip swings at low speed.
    Dissertation, section 1.3: a PI controller for small changes about a point of work. The integral stops at the
    request.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    if stays_out(p.regulator, w, slip):
        return inf
    slip = weighed(p.regulator, slip, motion)
    if w.limit == inf:
        w.integral = min(max(motion.torque, 0.0), wanted)
    error = p.regulator.target - slip
    gain = car.driven_wheel_inertia[motion.place] * max(motion.speed, p.regulator.slip.slowest)
    integral_gain = gain * (p.natural_frequency * p.natural_frequency * period)
    w.integral = min(max(w.integral + integral_gain * error, 0.0), wanted)
    torque = w.integral + gain * (2.0 * p.damping_ratio * p.natural_frequency) * error
    return until_served(p.regulator, w, period, torque, wanted)
