"""Assistance of the hands by the torque difference of two front drives (Shchur 2019, eq 4)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, SteeringColumnState, compilable, parameter


@compilable
def torque_difference_per_steering_moment(car: Car) -> float:
    """Difference of the front wheel torques that turns the road wheels with 1 N m: 2 r_k/d (Shchur 2019, eq 3)."""
    return 2.0 * car.wheel_radius / car.front_track


@dataclass(frozen=True, slots=True)
class AssistanceParameters:
    """Assistance and the virtual spring and damper, all at the steering wheel."""

    gamma: float = parameter(
        5.0, unit="1", low=0.0, high=50.0, about="amplification of the hand torque", source="Shchur 2019, fig. 1"
    )
    k_ck: float = parameter(
        0.051, unit="N m/rad", low=0.0, high=10.0, about="stiffness of the virtual spring", source="Shchur 2019, eq 7"
    )
    b_ck: float = parameter(
        0.062, unit="N m s/rad", low=0.0, high=10.0, about="virtual damping", source="Shchur 2019, eq 7"
    )


@compilable
def assistance(p: AssistanceParameters, column: SteeringColumnState) -> float:
    """Torque at the steering wheel besides that of the hands [N m]: gamma M_b - k_ck alpha - b_ck alpha' (eq 4)."""
    return p.gamma * column.hand_torque - p.k_ck * column.angle - p.b_ck * column.rate
