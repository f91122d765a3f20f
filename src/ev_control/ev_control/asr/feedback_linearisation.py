"""Slip control by feedback linearisation, also of the wheel's acceleration (dissertation)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

from ev_control.law import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    observed_slip,
    road_torque,
    traction_control,
)
from ev_control.shared.wheel_regulation import (
    RegulatedWheel,
    SlipRegulatorParameters,
    stays_out,
    until_served,
    weighed,
)
from ev_core.law import Car, compilable, group, parameter, part


@dataclass(frozen=True, slots=True)
class LinearisationParameters:
    """Decay of the slip error, and rate of change of the road; the source gives neither."""

    rate: float = parameter(
        25.0, unit="1/s", low=0.1, high=1000.0, about="decay of the slip error, k"
    )
    road_filter: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of road torque and acceleration"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class LinearisationWheel(RegulatedWheel):
    """State of a wheel."""

    road: Filtered = part(Filtered)  # torque that the road takes [N m]
    body_acceleration: Filtered = part(Filtered)  # of the car [m/s^2]


@traction_control("feedback_linearisation", reference="regulator.reference")
@compilable
def feedback_linearisation(
    p: LinearisationParameters,
    car: Car,
    w: LinearisationWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Choose the torque with which the slip error decays exponentially, on any tyre.

    With S = 1 - V/(r w), S' = ((1 - S) w' - V'/r)/w and J w' = M - M_road,

        M = M_road + J/(1 - S) (V'/r - k w (S - S*))

    gives S' = -k (S - S*) (dissertation, the first section 1.4, which names the method but gives no
    equation). The road torque M_road = M - J w' is measured and filtered, V' is the acceleration of
    the car. Near full slip 1/(1 - S) is taken at S = 0.9.
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
    # The command counts before the gear, which takes its part on the way to the wheel.
    return until_served(p.regulator, w, period, torque / car.motor.gear_efficiency, wanted)


@compilable
def acceleration_with_decay(
    p: Any, car: Car, slip: float, body_acceleration: float, motion: WheelMotion
) -> float:
    """Acceleration V'/r - k w (S - S*) [rad/s^2]: as (1 - S) w' it lets the slip error decay.

    From S = 1 - V/(r w), S' = ((1 - S) w' - V'/r)/w.
    """
    speed = max(motion.speed, p.regulator.slip.slowest)
    decay: float = p.rate * speed * (slip - p.regulator.target)
    return body_acceleration / car.wheel_radius - decay


@dataclass(frozen=True, slots=True)
class ModifiedLambdaParameters:
    """Decay of the slip error, and of that of the acceleration; the source gives neither."""

    rate: float = parameter(
        12.0, unit="1/s", low=0.1, high=1000.0, about="decay of the slip error, k"
    )
    acceleration_time: float = parameter(
        0.03,
        unit="s",
        low=1e-3,
        high=10.0,
        about="time constant of the wheel's acceleration behind the wanted one",
    )
    filter_time: float = parameter(
        0.01, unit="s", low=0.0, high=1.0, about="time constant of both accelerations"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class ModifiedLambdaWheel(RegulatedWheel):
    """State of a wheel."""

    wheel_acceleration: Filtered = part(Filtered)  # [rad/s^2]
    body_acceleration: Filtered = part(Filtered)  # of the car [m/s^2]


@traction_control("modified_lambda", reference="regulator.reference")
@compilable
def modified_lambda(
    p: ModifiedLambdaParameters,
    car: Car,
    w: ModifiedLambdaWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Regulate the wheel's acceleration to the one with which the slip error decays exponentially.

    S' = -k (S - S*) asks for w'* = (V'/r - k w (S - S*))/(1 - S), as in `feedback_linearisation`;
    the torque then follows by M' = J/T (w'* - w'), an integral action that needs no torque of the
    road and smooths its ripple. The source has no more than that w' is regulated (dissertation, the
    first section 1.4, figure 1.20); the rest is assumption. Near full slip 1/(1 - S) is taken at S
    = 0.9.
    """
    slip = observed_slip(p.regulator.slip, car, w.observer, period, motion)
    share = filter_share(period, p.filter_time)
    turning = follow(w.wheel_acceleration, motion.acceleration, share)
    moving = follow(w.body_acceleration, motion.body_acceleration, share)
    if stays_out(p.regulator, w, slip):
        return inf
    slip = weighed(p.regulator, slip, motion)
    # Integral action goes on from the last limit, at first from the torque that acts.
    before = min(w.limit, wanted)
    if w.limit == inf:
        before = min(max(motion.torque, 0.0), wanted)
    gap = acceleration_with_decay(p, car, slip, moving, motion) / (1.0 - min(slip, 0.9)) - turning
    torque = max(
        before + car.driven_wheel_inertia[motion.place] / p.acceleration_time * gap * period, 0.0
    )
    return until_served(p.regulator, w, period, torque, wanted)
