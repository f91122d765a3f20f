"""The modified lambda controller: feedback linearisation by the wheel's acceleration (dissertation, figure 1.20)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.first_order_filter import Filtered, filter_share, follow
from ev_control.estimation.slip_observers import observed_slip
from ev_control.estimation.wheel_dynamics import WheelMotion
from ev_control.law import RegulatedWheel, SlipRegulatorParameters, stays_out, until_served, weighed
from ev_control.shared.slip_regulator import acceleration_with_decay
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, compilable, group, parameter, part


@dataclass(frozen=True, slots=True)
class ModifiedLambdaParameters:
    """How fast the slip error decays, and how fast the wheel's acceleration follows; the source gives neither."""

    rate: float = parameter(12.0, unit="1/s", low=0.1, high=1000.0, about="decay of the slip error, k")
    acceleration_time: float = parameter(
        0.03,
        unit="s",
        low=1e-3,
        high=10.0,
        about="time constant with which the acceleration of the wheel follows the wanted one",
    )
    filter_time: float = parameter(0.01, unit="s", low=0.0, high=1.0, about="time constant of both accelerations")
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class ModifiedLambdaWheel(RegulatedWheel):
    """What the law knows of a wheel."""

    wheel_acceleration: Filtered = part(Filtered)  # [rad/s^2]
    body_acceleration: Filtered = part(Filtered)  # of the car [m/s^2]


@traction_control("modified_lambda", ModifiedLambdaParameters, ModifiedLambdaWheel, reference="regulator.reference")
@compilable
def modified_lambda(
    p: ModifiedLambdaParameters, car: Car, w: ModifiedLambdaWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Regulate the wheel's acceleration to the one with which the slip error decays exponentially.

    S' = -k (S - S*) asks for w'* = (V'/r - k w (S - S*))/(1 - S), as in `feedback_linearisation`; the torque then
    follows by M' = J/T (w'* - w'), an integral action that needs no torque of the road and smooths its ripple. The
    source only says that w' is regulated (dissertation, section 1.3, figure 1.20); the rest is assumption. Near full
    slip 1/(1 - S) is taken at S = 0.9.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    share = filter_share(period, p.filter_time)
    turning = follow(w.wheel_acceleration, motion.acceleration, share)
    moving = follow(w.body_acceleration, motion.body_acceleration, share)
    if stays_out(p.regulator, w, slip):
        return inf
    slip = weighed(p.regulator, slip, motion)
    before = min(w.limit, wanted)
    if w.limit == inf:
        before = min(max(motion.torque, 0.0), wanted)
    gap = acceleration_with_decay(p, car, slip, moving, motion) / (1.0 - min(slip, 0.9)) - turning
    torque = max(before + car.driven_wheel_inertia[motion.place] / p.acceleration_time * gap * period, 0.0)
    return until_served(p.regulator, w, period, torque, wanted)
