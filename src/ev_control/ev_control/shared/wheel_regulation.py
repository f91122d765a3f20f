"""Beginning and end of traction controls that regulate a slip or set a speed.

How it works: a limit has a beginning and an end, which are here, and a law that moves it in
between. Of a torque limit `stays_out` is before the beginning and `until_served` leads to the end.
A speed set-point does both in `moved`, by the sign of a course that the law gives.

They begin by the slip, or where a wheel gains on the car by the ratio of their accelerations
(dissertation, eq 1.4).
"""

from dataclasses import dataclass
from math import inf
from typing import Any

from ev_control.estimation import wheel_dynamics
from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_observers import SlipObserverParameters, SlipObserverState
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.traction_control import LimitedWheel
from ev_core.law import Car, ParameterError, compilable, entry, group, parameter, part


@dataclass(frozen=True, slots=True)
class SlipThresholdParameters:
    """The two ends of the range, printed as "0.15 > S > 0.19"."""

    low: float = parameter(
        0.15,
        unit="1",
        low=0.0,
        high=1.0,
        about="slip below which the torque may rise",
        source="dissertation, eq 1.5",
    )
    high: float = parameter(
        0.19,
        unit="1",
        low=0.0,
        high=1.0,
        about="slip above which it has to fall",
        source="dissertation, eq 1.5",
    )

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ParameterError(f"low is {self.low:g}, expected at most high, {self.high:g}")


@dataclass(frozen=True, slots=True)
class SlipRegulatorParameters:
    """The slip that is wanted, and what is measured of it; the source gives no number."""

    target: float = parameter(
        0.1,
        unit="1",
        low=0.01,
        high=0.5,
        about="wanted slip; the peaks of snow and wet asphalt lie at 0.09 and 0.13",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the limit has to be above the request before it ends",
    )
    at_rest: float = wheel_dynamics.share_at_rest(0.3)
    slip: SlipObserverParameters = group(SlipObserverParameters)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class RegulatedWheel(LimitedWheel):
    """State of a wheel with a regulated slip."""

    observer: SlipObserverState = part(SlipObserverState)
    served: float = entry(unit="s", about="since when the limit is above the request")


forget_regulation = wheel_dynamics.start_again(RegulatedWheel)


@compilable
def stays_out(p: SlipRegulatorParameters, w: RegulatedWheel, slip: float) -> bool:
    """Return true if a wheel is not limited, and its slip [1] is no reason to begin."""
    return w.limit == inf and slip <= p.target


@compilable
def weighed(p: SlipRegulatorParameters, slip: float, motion: wheel_dynamics.WheelMotion) -> float:
    """Slip [1] by which a limited wheel is regulated.

    About rest it weighs more, which is a smaller target.
    """
    return slip / wheel_dynamics.share_at(motion, p.slip.slowest, p.at_rest)


@compilable
def until_served(p: Any, w: Any, period: float, limit: float, wanted: float) -> float:
    """Limit [N m] until it has been above what is wanted for `release` [s], then infinity.

    The wheel has `served`, the time since when it is.
    """
    # A single step above the request is noise: only a while ends the limit.
    w.served = w.served + period if limit >= wanted else 0.0
    if w.served <= p.release:
        return limit
    w.served = 0.0
    return inf


@dataclass(frozen=True, slots=True)
class SpeedSetPointParameters:
    """Movement of the set-point; the source leaves open how fast, and when it rises."""

    lowering: float = parameter(
        200.0, unit="rad/s^2", low=0.1, high=1e5, about="fall of the set-point"
    )
    raising: float = parameter(
        60.0,
        unit="rad/s^2",
        low=0.1,
        high=1e5,
        about="rise of the set-point, faster than any car, to find the limit",
    )
    least_slip: float = parameter(
        0.02,
        unit="1",
        low=0.0,
        high=0.5,
        about="slip below which the set-point is not lowered: the drive needs torque",
    )
    served: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the request that a drive gives which is no longer limited",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which it has to before the set-point ends",
    )
    slowest: float = wheel_dynamics.slowest_wheel()
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class SpeedSetPointWheel(LimitedWheel):
    """State of a wheel with a speed set-point, which is its limit."""

    limit: float = entry(inf, unit="rad/s", about="largest speed that its drive goes for")
    served: float = entry(unit="s", about="since when the drive gives the request")


forget_set_point = wheel_dynamics.start_again(SpeedSetPointWheel)


@compilable
def moved(
    p: SpeedSetPointParameters,
    w: SpeedSetPointWheel,
    period: float,
    motion: wheel_dynamics.WheelMotion,
    course: float,
    serves: bool,
) -> float:
    """Set-point [rad/s] after a period: lowered, raised or held by the sign of `course`.

    It begins at the speed that the wheel has, and ends once the drive `serves` the request for a
    while.
    """
    if course < 0.0:
        w.served = 0.0
        # Below some slip the drive would brake, and take the torque away that it is to limit.
        least = motion.rolling + p.least_slip * max(motion.rolling, p.slowest)
        # From the speed that the wheel has, so that the drive begins to yield at once.
        return max(min(w.limit, motion.speed) - p.lowering * period, least)
    # Not limited, and no reason to begin.
    if w.limit == inf:
        return inf
    w.served = w.served + period if serves else 0.0
    if w.served > p.release:
        return inf
    return w.limit + p.raising * period if course > 0.0 else w.limit


@compilable
def serves_request(
    p: SpeedSetPointParameters, car: Car, motion: wheel_dynamics.WheelMotion, wanted: float
) -> bool:
    """Return true if the drive gives what is wanted [N m], so that it is no longer limited."""
    gives: bool = motion.torque >= p.served * car.motor.gear_efficiency * wanted
    return gives


@dataclass(frozen=True, slots=True)
class GainedSpeedParameters:
    """Speed that a gripping tyre may gain: its slip, and the winding up of its carcass."""

    grip_slip: float = parameter(
        0.07,
        unit="1",
        low=0.0,
        high=0.5,
        about="share of its speed that a wheel may gain on the car while its tyre grips; dry "
        "asphalt carries half of the load at a slip of 0.03",
    )
    least_gain: float = parameter(
        0.3,
        unit="rad/s",
        low=0.0,
        high=100.0,
        about="allowed gain at any speed: noise, a carcass that winds up",
    )
    memory: float = parameter(
        1.0,
        unit="s",
        low=0.01,
        high=100.0,
        about="time constant of forgetting the gained speed: no offset adds up",
    )


@compilable
def has_gained(p: Any, car: Car, w: Any, period: float, motion: wheel_dynamics.WheelMotion) -> bool:
    """Return true if a wheel has gained more on the car than a tyre that grips; keep how much."""
    # Leaky, so that an offset of the accelerometer does not add up.
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
        about="ratio of accelerations below which a wheel slips; 0.4 in the source, more than any "
        "wheel radius, would always be undercut; half the radius stands for a wheel that turns "
        "twice as fast as it would roll",
        source="assumption; dissertation, eq 1.4, has 0.4 m",
    )
    least_acceleration: float = parameter(
        6.0,
        unit="rad/s^2",
        low=0.0,
        high=1000.0,
        about="wheel acceleration below which the ratio is noise",
    )
    filter_time: float = parameter(
        0.03, unit="s", low=0.0, high=1.0, about="time constant of both accelerations"
    )


@dataclass(slots=True)
class Accelerations:
    """Both accelerations, filtered, and what they have added up to."""

    wheel: wheel_dynamics.Filtered = part(wheel_dynamics.Filtered)  # [rad/s^2]
    body: wheel_dynamics.Filtered = part(wheel_dynamics.Filtered)  # of the car [m/s^2]
    gained: float = entry(unit="rad/s", about="speed that the wheel has gained on the car lately")


@compilable
def gains_on_car(
    p: AccelerationCriterionParameters,
    car: Car,
    s: Accelerations,
    period: float,
    motion: wheel_dynamics.WheelMotion,
) -> bool:
    """Return true if a_x/w' < threshold, while w' is more than noise; nothing is divided.

    A tyre that grips needs slip for its force, and its carcass winds up first: what it gains by
    that does not count.
    """
    gained = has_gained(p, car, s, period, motion)
    share = wheel_dynamics.filter_share(period, p.filter_time)
    turning = wheel_dynamics.follow(s.wheel, motion.acceleration, share)
    moving = wheel_dynamics.follow(s.body, motion.body_acceleration, share)
    return gained and turning > p.least_acceleration and moving < p.threshold * turning
