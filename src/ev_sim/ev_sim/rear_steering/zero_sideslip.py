"""Rear wheels that keep the sideslip angle of the centre of mass at zero in steady turns."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, TireForces
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.rear_steering.rear_axle import PLANT, moment_of_road, shown
from ev_sim.steering_actuator.motor import Servo, SteeringMotorParameters, SteeringMotorState, servo, turn
from ev_sim.vehicle.understeer import axle_cornering_stiffnesses


class ZeroSideslipConstants(NamedTuple):
    """The motor, and the cornering stiffnesses of the axles on dry asphalt at static load."""

    servo: Servo
    front_stiffness: float  # C_1 [N/rad]
    rear_stiffness: float  # C_2 [N/rad]


def prepare(p: SteeringMotorParameters, vehicle: Vehicle, period: float) -> ZeroSideslipConstants:
    """The motor over a period [s], and the axles of the vehicle."""
    return ZeroSideslipConstants(servo(p, period), *axle_cornering_stiffnesses(vehicle))


@method(
    "rear_steering",
    "zero_sideslip",
    SteeringMotorParameters,
    state=SteeringMotorState,
    prepare=prepare,
    outputs=shown,
    requires=PLANT,
    mirrored=True,
)
@compilable
def zero_sideslip(
    p: SteeringMotorParameters,
    car: Car,
    c: ZeroSideslipConstants,
    s: SteeringMotorState,
    column: SteeringColumnState,
    velocity: BodyVelocity,
    tyres: TireForces,
) -> None:
    """Turn the rear wheels so that the linear car of its own tyres turns without sideslip.

    With forces m V r b/L in front and m V r a/L behind, slip angles delta_f - a r/V and delta_r + b r/V, and V_y = 0:
    delta_r/delta_f = (m a V^2/(L C_2) - b)/(m b V^2/(L C_1) + a), a and b from the centre of mass to the axles.
    """
    b = car.centre_of_mass_to_rear_axle
    a = car.wheelbase - b
    squared = car.mass * velocity.longitudinal * velocity.longitudinal / car.wheelbase
    ratio = (a * squared / c.rear_stiffness - b) / (b * squared / c.front_stiffness + a)
    turn(p, c.servo, s, ratio * column.road_wheel_angle, moment_of_road(p, tyres))
