"""Traction control by friction times load, learnt or by diagrams (dissertation, eq 1.2)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation import friction_estimate
from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    slip_angle_of,
)
from ev_control.estimation.wheel_dynamics import share_at_rest, start_again, wheel_load
from ev_control.law import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    road_torque,
    share_at,
    slip_of,
    slowest_wheel,
)
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.traction_control import LimitedWheel, traction_control
from ev_core.law import Car, compilable, entry, group, parameter, part, tan


@dataclass(frozen=True, slots=True)
class AdhesionLimitParameters(friction_estimate.FrictionLearningParameters):
    """Learning of the friction of the road, and share of it that is used."""

    use: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="used share of the estimate; with 1 a spinning wheel spins on",
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class AdhesionLimitWheel(LimitedWheel):
    """State of a wheel."""

    used: Filtered = part(Filtered)  # friction in use [1]
    friction: float = entry(
        unit="1", about="estimated friction of the road; at the start the largest one"
    )


_forget_limit = start_again(AdhesionLimitWheel)


@compilable
def forget_limit(p: AdhesionLimitParameters, w: AdhesionLimitWheel) -> None:
    """Put a wheel back to the start."""
    # The declared start does not depend on parameters, so the friction is set behind it.
    _forget_limit(w)
    w.friction = p.largest_friction


@traction_control("adhesion_limit", forget_limit)
@compilable
def adhesion_limit(
    p: AdhesionLimitParameters,
    car: Car,
    w: AdhesionLimitWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Limit each wheel to mu F_z r, by its load and the friction at which it last slipped.

    Dissertation, eq 1.2, at the wheel instead of the shaft; loads by `wheel_load`. The friction in
    use is (M - J w')/(F_z r); where the slip exceeds `learning_slip` it is that of the road, else
    the estimate slowly rises to `largest_friction` (assumption, see `learnt_friction`).
    """
    load = wheel_load(car, motion.place, motion.forward_acceleration, motion.lateral_acceleration)
    lever = load * car.wheel_radius
    # Without any load there is no friction to use.
    used = road_torque(car, motion) / lever if lever > 0.0 else 0.0
    used = follow(w.used, used, filter_share(period, p.filter_time))
    slips = slip_of(motion, p.slowest) > p.learning_slip
    w.friction = friction_estimate.learnt_friction(p, w.friction, used, slips, period)
    return p.use * w.friction * lever / car.motor.gear_efficiency


@dataclass(frozen=True, slots=True)
class ExpectedSignalParameters:
    """Diagrams, and the estimate that follows the difference between signal and expectation."""

    largest_friction: float = parameter(
        1.2, unit="1", low=0.01, high=3.0, about="friction at the start and at most"
    )
    least_friction: float = parameter(
        0.03, unit="1", low=1e-3, high=1.0, about="least friction that is believed in"
    )
    least_slip: float = parameter(
        0.02, unit="1", low=1e-3, high=0.5, about="slip below which nothing can be compared"
    )
    rise: float = parameter(
        0.3,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="rise of the estimate below that slip: a wheel that had spun shows less than the "
        "road carries, and a car on a slippery hill would stand for ever",
    )
    rate: float = parameter(
        50.0, unit="1/s", low=0.0, high=1000.0, about="correction of the estimate"
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of friction in use and slip"
    )
    use: float = parameter(
        0.95, unit="1", low=0.1, high=1.0, about="share of the expected peak that is used"
    )
    slowest: float = slowest_wheel()
    at_rest: float = share_at_rest(0.3)
    diagram: friction_estimate.FrictionDiagramParameters = group(
        friction_estimate.FrictionDiagramParameters
    )
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class ExpectedSignalWheel(LimitedWheel):
    """State of a wheel."""

    used: Filtered = part(Filtered)  # friction in use [1]
    slip: Filtered = part(Filtered)  # [1]
    friction: float = entry(
        unit="1", about="estimated friction of the road; at the start the largest one"
    )
    observer: SlipAngleObserverState = part(SlipAngleObserverState)


_forget_road = start_again(ExpectedSignalWheel)


@compilable
def forget_road(p: ExpectedSignalParameters, w: ExpectedSignalWheel) -> None:
    """Put a wheel back to the start."""
    _forget_road(w)
    w.friction = p.largest_friction


@traction_control("expected_signal", forget_road)
@compilable
def expected_signal(
    p: ExpectedSignalParameters,
    car: Car,
    w: ExpectedSignalWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Limit each wheel to the peak that stored diagrams expect on the road that its slip indicates.

    phi_x(s, alpha) with the estimated largest friction is what a wheel with this slip and slip
    angle should use; the estimate follows the difference to what it does use, (M - J w')/(F_z r),
    by `rate`; a wheel without slip shows nothing, and the estimate rises slowly. The limit is phi_x
    at the peak of the resultant slip, beside the slip angle, times load and radius. The
    dissertation (section 1.4) only names the analysis of the expected signal and its diagrams,
    phi_x over slip for slip angles and phi_y for largest coefficients.
    """
    load = wheel_load(car, motion.place, motion.forward_acceleration, motion.lateral_acceleration)
    lever = load * car.wheel_radius
    share = filter_share(period, p.filter_time)
    used = follow(w.used, road_torque(car, motion) / lever if lever > 0.0 else 0.0, share)
    slip = follow(
        w.slip, slip_of(motion, p.slowest) / share_at(motion, p.slowest, p.at_rest), share
    )
    angle = slip_angle_of(p.observer, car, w.observer, period, motion)
    lateral = tan(min(max(angle, -1.0), 1.0))
    if slip > p.least_slip:
        # What the diagram makes of a unit of the largest friction: small slips correct as fast as
        # large ones.
        share_of_peak = max(
            friction_estimate.expected_friction(p.diagram, w.friction, slip, lateral) / w.friction,
            p.least_slip,
        )
        gap = used / share_of_peak - w.friction
        w.friction = min(
            max(w.friction + min(p.rate * period, 1.0) * gap, p.least_friction), p.largest_friction
        )
    else:
        w.friction = min(w.friction + p.rise * period, p.largest_friction)
    peak = friction_estimate.friction_at_peak(p.diagram, w.friction, lateral)
    return p.use * peak * lever / car.motor.gear_efficiency
