"""Linear single-track model of references and controllers (Riekert & Schunck 1940)."""

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Vehicle, compilable, copysign, parameter


@dataclass(frozen=True, slots=True)
class SingleTrackParameters:
    """Tyres that the law believes in, and the speed below which it leaves the car alone."""

    front_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the front axle"
    )
    rear_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the rear axle"
    )
    slowest: float = parameter(
        2.0,
        unit="m/s",
        low=0.1,
        high=20.0,
        about="speed up to which there is no yaw moment; whole from twice of it on",
    )


class SingleTrack(NamedTuple):
    """Model v' = a_11 v + a_12 r + b_1 delta, r' = a_21 v + a_22 r + b_2 delta + M_z/J, all SI."""

    a_11: float
    a_12: float
    a_21: float
    a_22: float
    b_1: float
    b_2: float


@compilable
def single_track(p: SingleTrackParameters, car: Vehicle, speed: float) -> SingleTrack:
    """The model at a speed [m/s], which counts as at least `slowest`, ahead or in reverse.

    Tyres push against their way aside wherever they roll: F_1 = -C_1 ((v + a r)/|u| - sgn(u) delta)
    in front, F_2 = -C_2 (v - b r)/|u| behind, m (v' + u r) = F_1 + F_2, J r' = a F_1 - b F_2 + M_z.
    """
    ahead, u = copysign(1.0, speed), max(abs(speed), p.slowest)
    front, rear = p.front_cornering_stiffness, p.rear_cornering_stiffness
    b = car.centre_of_mass_to_rear_axle
    a = car.wheelbase - b
    turning = a * front - b * rear
    return SingleTrack(
        -(front + rear) / (car.mass * u),
        -turning / (car.mass * u) - ahead * u,
        -turning / (car.yaw_inertia * u),
        -(a * a * front + b * b * rear) / (car.yaw_inertia * u),
        ahead * front / car.mass,
        ahead * a * front / car.yaw_inertia,
    )


@compilable
def steady_lateral_velocity(model: SingleTrack, road_wheel_angle: float, yaw_rate: float) -> float:
    """Lateral velocity v* [m/s] of a steady turn, at an angle [rad] and a yaw rate [rad/s]."""
    return -(model.a_12 * yaw_rate + model.b_1 * road_wheel_angle) / model.a_11


@compilable
def steady_moment(
    car: Vehicle, model: SingleTrack, road_wheel_angle: float, yaw_rate: float
) -> float:
    """Yaw moment [N m] that holds the car there: M_z = -J (a_21 v* + a_22 r + b_2 delta)."""
    lateral = steady_lateral_velocity(model, road_wheel_angle, yaw_rate)
    return -car.yaw_inertia * (
        model.a_21 * lateral + model.a_22 * yaw_rate + model.b_2 * road_wheel_angle
    )
