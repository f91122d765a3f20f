"""How much of a slip threshold a side force leaves (dissertation, section 1.4)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    slip_angles_at,
)
from ev_control.estimation.wheel_dynamics import WheelMotion
from ev_core.law import Car, compilable, group, parameter, part, sqrt

CORRECTIONS = ("none", "ellipse")
NONE, ELLIPSE = range(len(CORRECTIONS))
FRONT_WHEELS = 2  # places below it


@dataclass(frozen=True, slots=True)
class SideForceParameters:
    """The form of the correction, of which the source only says that the friction diagram gives it."""

    correction: str = parameter(
        "none",
        choices=CORRECTIONS,
        about="of slip thresholds by the slip angle: none; or ellipse, S sqrt(1 - (alpha/alpha_max)^2)",
        source="dissertation, section 1.4, has no formula: the ellipse is an assumption",
    )
    largest_slip_angle: float = parameter(
        0.12, unit="rad", low=0.01, high=1.0, about="slip angle of the largest side force, alpha_max"
    )
    least: float = parameter(0.2, unit="1", low=0.0, high=1.0, about="share of a threshold that is always left")
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)


@dataclass(slots=True)
class SideForceState:
    """What lasts between steps."""

    observer: SlipAngleObserverState = part(SlipAngleObserverState)


@compilable
def slip_angle_of(
    p: SlipAngleObserverParameters, car: Car, s: SlipAngleObserverState, period: float, motion: WheelMotion
) -> float:
    """Estimated slip angle of the wheel's axle [rad], counted only forwards; in reverse it is zero."""
    if motion.ahead < 0.0:
        return 0.0
    angles = slip_angles_at(
        p, car, s, period, motion.car_speed, motion.lateral_acceleration, motion.yaw_rate, motion.road_wheel_angle
    )
    return angles.front if motion.place < FRONT_WHEELS else angles.rear


@compilable
def share_left(p: SideForceParameters, car: Car, s: SideForceState, period: float, motion: WheelMotion) -> float:
    """What is left of a slip threshold [1]: sqrt(1 - (alpha/alpha_max)^2), at least `least`; 1 without correction."""
    if p.correction == NONE:
        return 1.0
    use = slip_angle_of(p.observer, car, s.observer, period, motion) / p.largest_slip_angle
    return max(sqrt(max(1.0 - use * use, 0.0)), p.least)
