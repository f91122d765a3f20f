"""What traction controls of drives in speed mode share: torques pass, and a slipping wheel gets a set-point."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.first_order_filter import start_again
from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.wheel_dynamics import WheelMotion, slowest_wheel
from ev_control.shared.traction_control import LimitedWheel
from ev_core.law import Car, compilable, entry, group, parameter


@dataclass(frozen=True, slots=True)
class SpeedSetPointParameters:
    """How the set-point moves; the source says that it is lowered, and neither how fast nor when it is raised."""

    lowering: float = parameter(200.0, unit="rad/s^2", low=0.1, high=1e5, about="fall of the set-point")
    raising: float = parameter(
        60.0,
        unit="rad/s^2",
        low=0.1,
        high=1e5,
        about="rise of the set-point; faster than any road lets the car gain speed, so that it finds the limit again",
    )
    least_slip: float = parameter(
        0.02,
        unit="1",
        low=0.0,
        high=0.5,
        about="slip below which the set-point is not lowered: a lower one would be a drive without torque",
    )
    served: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the request that the drive gives where the set-point does not limit it any more",
    )
    release: float = parameter(
        0.2, unit="s", low=0.0, high=100.0, about="time for which it has to before the set-point ends"
    )
    slowest: float = slowest_wheel()
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class SpeedSetPointWheel(LimitedWheel):
    """What a law of set-points knows of a wheel; its limit is a speed."""

    limit: float = entry(inf, unit="rad/s", about="largest speed that its drive goes for")
    served: float = entry(unit="s", about="since when the drive gives the request")


forget_set_point = start_again(SpeedSetPointWheel)


@compilable
def moved(
    p: SpeedSetPointParameters,
    car: Car,
    w: SpeedSetPointWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
    course: float,
) -> float:
    """The set-point [rad/s] after a period: lowered if `course` is below zero, raised above it, else held.

    It begins at the speed that the wheel has, and ends once the drive has given what is wanted [N m] for a while.
    """
    if course < 0.0:
        w.served = 0.0
        least = motion.rolling + p.least_slip * max(motion.rolling, p.slowest)
        return max(min(w.limit, motion.speed) - p.lowering * period, least)
    if w.limit == inf:
        return inf
    gives = motion.torque >= p.served * car.motor.gear_efficiency * wanted
    w.served = w.served + period if gives else 0.0
    if w.served > p.release:
        return inf
    return w.limit + p.raising * period if course > 0.0 else w.limit
