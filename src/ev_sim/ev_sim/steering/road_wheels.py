"""The steered road wheels: parameters of eq 3 of Shchur (2019), and what of them is common to all columns."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, SteeringColumnState, Vehicle, WheelStates, compilable, parameter
from ev_sim.steering.friction_oscillator import Oscillator, oscillator


@compilable
def speed_difference(wheels: WheelStates) -> float:
    """Right minus left front wheel speed [rad/s]."""
    return wheels.velocity.front_right - wheels.velocity.front_left


@compilable
def drive_moment(
    car: Car, wheel_inertia: float, period: float, wheels: WheelStates, last_speed_difference: float
) -> float:
    """Steering moment of the drive forces, left positive [N m]: d/(2 r_k) (M_R - M_L) - J_k d/(2 r_k) (w_R' - w_L').

    The torques are the actual ones at the wheels. The wheel accelerations of a period are the difference of the
    speeds at its two ends before, so they come one period late: the column reads no later speed.
    """
    lever = car.front_track / (2 * car.wheel_radius)
    torque_difference = wheels.effort.front_right - wheels.effort.front_left
    acceleration_torque = wheel_inertia / period * (speed_difference(wheels) - last_speed_difference)
    return lever * (torque_difference - acceleration_torque)


@dataclass(frozen=True, slots=True)
class RoadWheelParameters:
    """The steering system at the road wheels (eq 3 without the drives)."""

    inertia: float = parameter(
        2.8, unit="kg m^2", low=0.001, high=1000.0, about="inertia of the steering system, J_p", source="Shchur 2019"
    )
    damping: float = parameter(
        7.5, unit="N m s/rad", low=0.0, high=10000.0, about="viscous friction, b_p", source="Shchur 2019"
    )
    stiffness: float = parameter(
        65.0, unit="N m/rad", low=0.001, high=100000.0, about="restoring stiffness, k_p", source="Shchur 2019"
    )
    dry_friction: float = parameter(
        0.0,
        unit="N m",
        low=0.0,
        high=1000.0,
        about="dry friction, M_c, the same at rest and in motion; the paper gives no value, 0 reproduces eqs 6 and 7",
        source="Shchur 2019, eq 3",
    )
    max_angle: float = parameter(
        2.0,
        unit="rad",
        low=0.01,
        high=3.14,
        about="road-wheel angle of the end stops; the paper has none, 2 lies outside its runs, a car has about 0.7",
    )


@dataclass(frozen=True, slots=True)
class DrivenRoadWheelParameters(RoadWheelParameters):
    """The steering system at the road wheels, on which the difference of the drive forces acts (eq 3)."""

    wheel_inertia: float = parameter(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=100.0,
        about="inertia of one wheel with its drive, J_k in eq 3; 0 neglects that term as the paper does",
        source="Shchur 2019, eqs 1 and 3",
    )


def road_wheels(parameters: RoadWheelParameters, _vehicle: Vehicle, period: float) -> Oscillator:
    """The motion of the road wheels (eq 3), exact over a period [s]."""
    p = parameters
    return oscillator(p.inertia, p.damping, p.stiffness, p.dry_friction, p.max_angle, period)


@compilable
def connected_column(
    car: Car, road_wheel_angle: float, road_wheel_rate: float, hand_torque: float
) -> SteeringColumnState:
    """What sensors measure of a column that is mechanically connected: the steering wheel turns i times as far."""
    ratio = car.steering_ratio
    return SteeringColumnState(
        ratio * road_wheel_angle, ratio * road_wheel_rate, hand_torque, road_wheel_angle, road_wheel_rate
    )
