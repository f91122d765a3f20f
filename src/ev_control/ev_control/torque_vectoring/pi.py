"""Yaw rate by a PI controller (De Novellis, Sorniotti & Gruber 2014, IEEE TVT 63(8), 3612)."""

from dataclasses import dataclass

from ev_control.torque_vectoring.integral import MomentIntegral
from ev_core.law import Car, compilable, parameter


@dataclass(frozen=True, slots=True)
class PIParameters:
    """Gains over the yaw inertia; the source schedules its own by speed."""

    bandwidth: float = parameter(
        10.0, unit="1/s", low=0.0, high=200.0, about="proportional gain over the yaw inertia"
    )
    integral_rate: float = parameter(
        5.0, unit="1/s", low=0.0, high=100.0, about="integral over proportional gain"
    )


@compilable
def pi_moment(p: PIParameters, car: Car, s: MomentIntegral, period: float, error: float) -> float:
    """M_z = -J w (e + rate int(e) dt) [N m], with the error of the yaw rate e = r - r* [rad/s]."""
    proportional = car.yaw_inertia * p.bandwidth * error
    s.moment -= p.integral_rate * period * proportional
    return s.moment - proportional
