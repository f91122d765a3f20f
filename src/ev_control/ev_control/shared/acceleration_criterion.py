"""Whether a wheel gains on the car, by the ratio of their accelerations (dissertation, eq 1.4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_control.estimation.wheel_dynamics import Filtered, WheelMotion, filter_share, follow
from ev_core.law import Car, compilable, entry, parameter, part


@dataclass(frozen=True, slots=True)
class GainedSpeedParameters:
    """What a tyre that grips may gain: its slip, and the winding up of its carcass."""

    grip_slip: float = parameter(
        0.07,
        unit="1",
        low=0.0,
        high=0.5,
        about="share of its speed that a wheel may gain on the car while its tyre grips; dry asphalt carries half of "
        "the load at a slip of 0.03",
    )
    least_gain: float = parameter(
        0.3, unit="rad/s", low=0.0, high=100.0, about="allowed gain at any speed: noise, a carcass that winds up"
    )
    memory: float = parameter(
        1.0, unit="s", low=0.01, high=100.0, about="time constant of forgetting the gained speed: no offset adds up"
    )


@compilable
def has_gained(p: Any, car: Car, w: Any, period: float, motion: WheelMotion) -> bool:
    """Whether a wheel has gained more on the car than a tyre that grips; `w.gained` is what it has [rad/s]."""
    gain = motion.acceleration - motion.body_acceleration / car.wheel_radius
    w.gained = max(w.gained + gain * period, 0.0) * p.memory / (p.memory + period)
    gained: bool = w.gained > max(p.grip_slip * motion.speed, p.least_gain)
    return gained


@dataclass(frozen=True, slots=True)
class AccelerationCriterionParameters(GainedSpeedParameters):
    """The ratio that separates slip from grip."""

    threshold: float = parameter(
        0.16,
        unit="m",
        low=0.0,
        high=10.0,
        about="ratio of accelerations below which a wheel slips; 0.4 in the source, more than any wheel radius, would "
        "always be undercut; half the radius stands for a wheel that turns twice as fast as it would roll",
        source="assumption; dissertation, eq 1.4, has 0.4 m",
    )
    least_acceleration: float = parameter(
        6.0, unit="rad/s^2", low=0.0, high=1000.0, about="wheel acceleration below which the ratio is noise"
    )
    filter_time: float = parameter(0.03, unit="s", low=0.0, high=1.0, about="time constant of both accelerations")


@dataclass(slots=True)
class Accelerations:
    """Both accelerations, filtered, and what they have added up to."""

    wheel: Filtered = part(Filtered)  # [rad/s^2]
    body: Filtered = part(Filtered)  # of the car [m/s^2]
    gained: float = entry(unit="rad/s", about="speed that the wheel has gained on the car lately")


@compilable
def gains_on_car(
    p: AccelerationCriterionParameters, car: Car, s: Accelerations, period: float, motion: WheelMotion
) -> bool:
    """Whether a_x/w' < threshold, compared without dividing, and only while w' is more than noise.

    A tyre that grips needs slip for its force, and its carcass winds up first: what it gains by that does not count.
    """
    gained = has_gained(p, car, s, period, motion)
    share = filter_share(period, p.filter_time)
    turning = follow(s.wheel, motion.acceleration, share)
    moving = follow(s.body, motion.body_acceleration, share)
    return gained and turning > p.least_acceleration and moving < p.threshold * turning
