"""Traction control by estimated friction times load (dissertation, eq 1.2)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.first_order_filter import Filtered, filter_share, follow, start_again
from ev_control.estimation.friction_estimate import FrictionLearningParameters, learnt_friction
from ev_control.estimation.plausible import wheel_load
from ev_control.law import LimitedWheel, LimpModeParameters, ReferenceSpeedParameters, WheelMotion, road_torque, slip_of
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, compilable, entry, group, parameter, part


@dataclass(frozen=True, slots=True)
class AdhesionLimitParameters(FrictionLearningParameters):
    """How the friction of the road is learnt, and how much of it is used."""

    use: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the estimate that is used; at 1 a wheel that spins has just the torque to spin on",
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class AdhesionLimitWheel(LimitedWheel):
    """What the law knows of a wheel."""

    used: Filtered = part(Filtered)  # friction in use [1]
    friction: float = entry(unit="1", about="estimated friction of the road; at the start the largest one")


start = start_again(AdhesionLimitWheel)


@compilable
def forget(p: AdhesionLimitParameters, w: AdhesionLimitWheel) -> None:
    """Put a wheel back to the start."""
    start(w)
    w.friction = p.largest_friction


@traction_control("adhesion_limit", AdhesionLimitParameters, AdhesionLimitWheel, forget)
@compilable
def adhesion_limit(
    p: AdhesionLimitParameters, car: Car, w: AdhesionLimitWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Limit each wheel to mu F_z r, with the load by the accelerations and the friction at which it last slipped.

    Dissertation, eq 1.2, at the wheel instead of the shaft; loads by `wheel_load`. The friction in use is
    (M - J w')/(F_z r); where the slip exceeds `learning_slip` it is that of the road, else the estimate slowly rises to
    `largest_friction` (assumption, see `learnt_friction`).
    """
    load = wheel_load(car, motion.place, motion.forward_acceleration, motion.lateral_acceleration)
    lever = load * car.wheel_radius
    used = road_torque(car, motion) / lever if lever > 0.0 else 0.0  # without any load there is nothing to use
    used = follow(w.used, used, filter_share(period, p.filter_time))
    w.friction = learnt_friction(p, w.friction, used, slip_of(motion, p.slowest), period)
    return p.use * w.friction * lever / car.motor.gear_efficiency
