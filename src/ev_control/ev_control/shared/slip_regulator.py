"""What traction controls that regulate a slip share: when they begin, and when they end."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

from ev_control.estimation.first_order_filter import start_again
from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_observers import SlipObserverParameters, SlipObserverState
from ev_control.estimation.wheel_dynamics import WheelMotion, share_at, share_at_rest
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.traction_control import LimitedWheel
from ev_core.law import Car, compilable, entry, group, parameter, part


@dataclass(frozen=True, slots=True)
class SlipRegulatorParameters:
    """The slip that is wanted, and what is measured of it; the source gives no number."""

    target: float = parameter(
        0.1, unit="1", low=0.01, high=0.5, about="wanted slip; the peaks of snow and wet asphalt lie at 0.09 and 0.13"
    )
    release: float = parameter(
        0.2, unit="s", low=0.0, high=100.0, about="time for which the limit has to be above the request before it ends"
    )
    at_rest: float = share_at_rest(0.3)
    slip: SlipObserverParameters = group(SlipObserverParameters)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class RegulatedWheel(LimitedWheel):
    """What a law that regulates a slip knows of a wheel."""

    observer: SlipObserverState = part(SlipObserverState)
    served: float = entry(unit="s", about="since when the limit is above the request")


forget_regulation = start_again(RegulatedWheel)


@compilable
def stays_out(p: SlipRegulatorParameters, w: RegulatedWheel, slip: float) -> bool:
    """Whether a wheel is not limited, and its slip [1] is no reason to begin."""
    return w.limit == inf and slip <= p.target


@compilable
def weighed(p: SlipRegulatorParameters, slip: float, motion: WheelMotion) -> float:
    """The slip [1] as a limited wheel is regulated by it: about rest it weighs more, which is a smaller target."""
    return slip / share_at(motion, p.slip.slowest, p.at_rest)


@compilable
def acceleration_with_decay(p: Any, car: Car, slip: float, body_acceleration: float, motion: WheelMotion) -> float:
    """V'/r - k w (S - S*) [rad/s^2]: with it as (1 - S) w' the slip error decays, S' = -k (S - S*); `rate` is k.

    From S = 1 - V/(r w), S' = ((1 - S) w' - V'/r)/w.
    """
    speed = max(motion.speed, p.regulator.slip.slowest)
    decay: float = p.rate * speed * (slip - p.regulator.target)
    return body_acceleration / car.wheel_radius - decay


@compilable
def until_served(p: Any, w: Any, period: float, limit: float, wanted: float) -> float:
    """The limit [N m] until it has been above what is wanted [N m] for `release` [s], then infinity.

    The wheel has `served`, the time since when it is.
    """
    w.served = w.served + period if limit >= wanted else 0.0
    if w.served <= p.release:
        return limit
    w.served = 0.0
    return inf
