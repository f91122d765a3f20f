"""A steering column that only the driver turns (Shchur 2019, eq 3 without the differential torque)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.vehicle.car import Car
from ev_sim.steering_column.friction_oscillator import Oscillator, oscillated
from ev_sim.steering_column.road_wheels import RoadWheelParameters, connected_column, road_wheels


@dataclass(slots=True)
class ManualState:
    """The road wheels and the hands; left positive."""

    road_wheel_angle: float = entry(unit="rad")
    road_wheel_rate: float = entry(unit="rad/s")
    hand_torque: float = entry(unit="N m", about="what acted up to now")


@compilable
def shown(car: Car, s: ManualState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return connected_column(car, s.road_wheel_angle, s.road_wheel_rate, s.hand_torque)


@method(
    "steering_column",
    "manual",
    RoadWheelParameters,
    state=ManualState,
    prepare=road_wheels,
    outputs=shown,
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
