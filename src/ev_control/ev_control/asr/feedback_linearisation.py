"""Nonlinear slip control by feedback linearisation (dissertation, section 1.3, figure 1.19)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.first_order_filter import Filtered, filter_share, follow
from ev_control.estimation.slip_observers import observed_slip
from ev_control.estimation.wheel_dynamics import WheelMotion, road_torque
from ev_control.law import RegulatedWheel, SlipRegulatorParameters, stays_out, until_served, weighed
from ev_control.shared.slip_regulator import acceleration_with_decay
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, compilable, group, parameter, part


@dataclass(frozen=True, slots=True)
class FeedbackLinearisationParameters:
    """How fast the slip error decays, and how fast the road is believed to change; the source gives neither."""

    rate: float = parameter(25.0, unit="1/s", low=0.1, high=1000.0, about="decay of the slip error, k")
    road_filter: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of road torque and acceleration"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class FeedbackLinearisationWheel(RegulatedWheel):
    """What the law knows of a wheel."""

    road: Filtered = part(Filtered)  # torque that the road takes [N m]
    body_acceleration: Filtered = part(Filtered)  # of the car [m/s^2]


@traction_control(
    "feedback_linearisation",
    FeedbackLinearisationParameters,
    FeedbackLinearisationWheel,
    reference="regulator.reference",
)
@compilable
def feedback_linearisation(
    p: FeedbackLinearisationParameters,
    car: Car,
    w: FeedbackLinearisationWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Choose the torque that makes the slip error decay exponentially, whatever the tyre's curve is.

    With S = 1 - V/(r w), S' = ((1 - S) w' - V'/r)/w and J w' = M - M_road,

        M = M_road + J/(1 - S) (V'/r - k w (S - S*))

    gives S' = -k (S - S*) (dissertation, section 1.3, which names the method but gives no equation). The road torque
    M_road = M - J w' is measured and filtered, V' is the acceleration of the car. Near full slip 1/(1 - S) is taken
    at S = 0.9.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    share = filter_share(period, p.road_filter)
    road = follow(w.road, road_torque(car, motion), share)
    acceleration = follow(w.body_acceleration, motion.body_acceleration, share)
    if stays_out(p.regulator, w, slip):
        return inf
    slip = weighed(p.regulator, slip, motion)
    needed = acceleration_with_decay(p, car, slip, acceleration, motion)
    torque = road + car.driven_wheel_inertia[motion.place] / (1.0 - min(slip, 0.9)) * needed
    return until_served(p.regulator, w, period, torque / car.motor.gear_efficiency, wanted)
