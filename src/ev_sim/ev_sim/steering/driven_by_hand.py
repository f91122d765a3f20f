"""Steering columns that the driver turns, alone or with the difference of the front drives (Shchur 2019, eq 3)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, DriverCommand, SteeringColumnState, WheelStates, compilable, entry, method
from ev_sim.steering.friction_oscillator import Oscillator, oscillated
from ev_sim.steering.road_wheels import (
    DrivenRoadWheelParameters,
    RoadWheelParameters,
    connected_column,
    drive_moment,
    road_wheels,
    speed_difference,
)


@dataclass(slots=True)
class ManualState:
    """The road wheels and the hands; left positive."""

    road_wheel_angle: float = entry(unit="rad")
    road_wheel_rate: float = entry(unit="rad/s")
    hand_torque: float = entry(unit="N m", about="what acted up to now")


@compilable
def manual_column(car: Car, s: ManualState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return connected_column(car, s.road_wheel_angle, s.road_wheel_rate, s.hand_torque)


@method(
    "steering_column",
    "manual",
    RoadWheelParameters,
    state=ManualState,
    prepare=road_wheels,
    outputs=manual_column,
    mirrored=True,
)
@compilable
def manual(car: Car, c: Oscillator, s: ManualState, driver: DriverCommand) -> None:
    """Turn the road wheels by hand alone: a steering geometry that gives the drive forces no lever arm.

    J_p d'' + b_p d' + k_p d = i M_b - M_c sgn(d'), with d the road-wheel angle and M_b the hand torque at the steering
    wheel, both left positive; the steering-wheel angle is i d. Shchur (2019), eqs 3 and 6.
    """
    s.hand_torque = driver.hand_torque
    moment = car.steering_ratio * driver.hand_torque
    s.road_wheel_angle, s.road_wheel_rate = oscillated(c, s.road_wheel_angle, s.road_wheel_rate, moment)


@dataclass(slots=True)
class PoweredState:
    """The road wheels, the hands, and the front wheels; left positive."""

    road_wheel_angle: float = entry(unit="rad")
    road_wheel_rate: float = entry(unit="rad/s")
    hand_torque: float = entry(unit="N m", about="what acted up to now")
    wheel_speed_difference: float = entry(unit="rad/s", about="right minus left front wheel, a period ago")


@compilable
def powered_column(car: Car, s: PoweredState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return connected_column(car, s.road_wheel_angle, s.road_wheel_rate, s.hand_torque)


@method(
    "steering_column",
    "powered",
    DrivenRoadWheelParameters,
    state=PoweredState,
    prepare=road_wheels,
    outputs=powered_column,
    mirrored=True,
)
@compilable
def powered(
    p: DrivenRoadWheelParameters,
    car: Car,
    c: Oscillator,
    s: PoweredState,
    period: float,
    driver: DriverCommand,
    wheels: WheelStates,
) -> None:
    """Turn the road wheels by hand and by the difference of the front drive torques (eq 3 in full).

    J_p d'' + b_p d' + k_p d = d_track/(2 r_k) (M_R - M_L) + i M_b - M_c sgn(d') - J_k d_track/(2 r_k) (w_R' - w_L'),
    with d the road-wheel angle, M_R and M_L the actual drive torques of the front wheels and M_b the hand torque at
    the steering wheel; left positive; the steering-wheel angle is i d. Shchur (2019), eq 3. The wheels start at rest.
    """
    moment = drive_moment(car, p.wheel_inertia, period, wheels, s.wheel_speed_difference)
    moment += car.steering_ratio * driver.hand_torque
    s.wheel_speed_difference = speed_difference(wheels)
    s.hand_torque = driver.hand_torque
    s.road_wheel_angle, s.road_wheel_rate = oscillated(c, s.road_wheel_angle, s.road_wheel_rate, moment)
