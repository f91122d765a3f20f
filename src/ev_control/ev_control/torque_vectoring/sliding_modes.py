"""Yaw rate by sliding modes on s = r - r*: of first order with a boundary layer, and of second order (super-twisting).

First order: Slotine & Li (1991), Applied nonlinear control, chapter 7. Super-twisting: Levant (1993), Sliding order and
sliding accuracy in sliding mode control, Int. J. Control 58; gains as in Levant (1998), Robust exact differentiation
via sliding mode technique, Automatica 34.
"""

from dataclasses import dataclass

from ev_control.torque_vectoring.integral import MomentIntegral
from ev_core.law import Car, compilable, parameter, sqrt


@dataclass(frozen=True, slots=True)
class SlidingModeParameters:
    """How hard the car is turned towards the surface, and the layer that takes the chatter away."""

    reaching: float = parameter(
        3.0, unit="rad/s^2", low=0.0, high=100.0, about="yaw acceleration towards the wanted yaw rate"
    )
    layer: float = parameter(
        0.15, unit="rad/s", low=0.001, high=10.0, about="error up to which it is in proportion to the error"
    )


@compilable
def sliding_mode_moment(p: SlidingModeParameters, car: Car, error: float) -> float:
    """M_z = -J reaching sat(s/layer) [N m], with s the error of the yaw rate [rad/s]."""
    return -car.yaw_inertia * p.reaching * min(max(error / p.layer, -1.0), 1.0)


@dataclass(frozen=True, slots=True)
class SuperTwistingParameters:
    """The disturbance that is held against, from which both gains follow, and the layer that takes the chatter away."""

    roughness: float = parameter(
        6.0, unit="rad/s^3", low=0.0, high=1000.0, about="bound C of the rate of what disturbs the yaw acceleration"
    )
    layer: float = parameter(
        0.02, unit="rad/s", low=1e-6, high=10.0, about="error up to which both parts are in proportion to the error",
        source="assumption; the source has none, and steps that are short enough",
    )  # fmt: skip


@compilable
def super_twisting_moment(
    p: SuperTwistingParameters, car: Car, s: MomentIntegral, period: float, error: float
) -> float:
    """M_z = -J (1.5 sqrt(C |s|) sgn(s) + int(1.1 C sgn(s)) dt) [N m], with s the error of the yaw rate [rad/s].

    Within the layer |s| and sgn(s) stand for `layer` and s/layer.
    """
    side = min(max(error / p.layer, -1.0), 1.0)
    s.moment -= car.yaw_inertia * 1.1 * p.roughness * period * side
    return s.moment - car.yaw_inertia * 1.5 * sqrt(p.roughness * max(abs(error), p.layer)) * side
