"""Yaw rate by sliding modes on s = r - r*, of first and of second order.

First order: Slotine & Li (1991), Applied nonlinear control, chapter 7. Super-twisting: Levant
(1993), Sliding order and sliding accuracy in sliding mode control, Int. J. Control 58; gains as in
Levant (1998), Robust exact differentiation via sliding mode technique, Automatica 34. Suboptimal:
Bartolini, Ferrara & Usai (1998), Chattering avoidance by second-order sliding mode control, IEEE
Trans. Automatic Control 43(2), 241-246.
"""

from dataclasses import dataclass

from ev_control.estimation.wheel_dynamics import start_again
from ev_control.torque_vectoring.integral import MomentIntegral
from ev_core.law import Car, compilable, copysign, entry, parameter, sqrt


@dataclass(frozen=True, slots=True)
class SlidingModeParameters:
    """Acceleration towards the surface, and the layer that takes the chatter away."""

    reaching: float = parameter(
        3.0,
        unit="rad/s^2",
        low=0.0,
        high=100.0,
        about="yaw acceleration towards the wanted yaw rate",
    )
    layer: float = parameter(
        0.15,
        unit="rad/s",
        low=0.001,
        high=10.0,
        about="error up to which it is in proportion to the error",
    )


@compilable
def sliding_mode_moment(p: SlidingModeParameters, car: Car, error: float) -> float:
    """M_z = -J reaching sat(s/layer) [N m], with s the error of the yaw rate [rad/s]."""
    return -car.yaw_inertia * p.reaching * min(max(error / p.layer, -1.0), 1.0)


@dataclass(frozen=True, slots=True)
class SuperTwistingParameters:
    """Disturbance that gives both gains, and the layer that takes the chatter away."""

    roughness: float = parameter(
        6.0,
        unit="rad/s^3",
        low=0.0,
        high=1000.0,
        about="bound C of the rate of what disturbs the yaw acceleration",
    )
    layer: float = parameter(
        0.02,
        unit="rad/s",
        low=1e-6,
        high=10.0,
        about="error up to which both parts are in proportion to the error",
        source="assumption; the source has none, and steps that are short enough",
    )


@compilable
def super_twisting_moment(
    p: SuperTwistingParameters, car: Car, s: MomentIntegral, period: float, error: float
) -> float:
    """Yaw moment M_z = -J (1.5 sqrt(C |s|) sgn(s) + int(1.1 C sgn(s)) dt) [N m].

    Within the layer |s| and sgn(s) stand for `layer` and s/layer.
    """
    side = min(max(error / p.layer, -1.0), 1.0)
    # 1.1 C and 1.5 sqrt(C) are the gains of Levant (1998) for a rate of the disturbance below C.
    s.moment -= car.yaw_inertia * 1.1 * p.roughness * period * side
    return s.moment - car.yaw_inertia * 1.5 * sqrt(p.roughness * max(abs(error), p.layer)) * side


@dataclass(frozen=True, slots=True)
class SuboptimalParameters:
    """Rate of the moment, and the layer that takes the chatter away."""

    rate: float = parameter(
        12.0,
        unit="rad/s^3",
        low=0.0,
        high=1000.0,
        about="rate V_M of the yaw acceleration by the moment; it holds against disturbances of "
        "up to half of it",
    )
    layer: float = parameter(
        0.05,
        unit="rad/s",
        low=1e-6,
        high=10.0,
        about="distance of the error from half its extremum up to which the rate is in proportion "
        "to it",
        source="assumption; the source has none, and steps that are short enough",
    )


@dataclass(slots=True)
class SuboptimalState:
    """The last extremum of the error, and what shows the next one."""

    extremum: float = entry(unit="rad/s", about="last extremum of the error")
    before: float = entry(unit="rad/s", about="error of the step before")
    way: float = entry(unit="1", about="sign of its last change, 0 before there is an error")


@compilable
def suboptimal_moment(
    p: SuboptimalParameters,
    car: Car,
    s: SuboptimalState,
    integral: MomentIntegral,
    period: float,
    error: float,
) -> float:
    """Yaw moment M_z = -J int(V_M sgn(s - s_M/2)) dt [N m], s_M the last extremum of s.

    The source's alpha* may be 1, because the gain of the moment's rate in s'' is known, 1/J: V_M >
    2 F is enough for disturbances |s'' + V_M sgn(s - s_M/2)| < F. Within the layer (s -
    s_M/2)/`layer` stands for the sign.
    """
    # The first error stands for an extremum, until it turns.
    if s.way == 0.0 and error != 0.0:
        s.extremum = error
        s.before = error
        s.way = copysign(1.0, error)
    # The error has turned: the last one was an extremum.
    if s.way * (error - s.before) < 0.0:
        s.extremum = s.before
        s.way = -s.way
    s.before = error
    # It switches at half of the last extremum, before the error gets to zero.
    side = min(max((error - s.extremum / 2.0) / p.layer, -1.0), 1.0)
    integral.moment -= car.yaw_inertia * p.rate * period * side
    return integral.moment


forget_extrema = start_again(SuboptimalState)
