"""What all laws of the rear wheels' angle share: the motor, the moment of the road, and what is shown."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.actuator_signals import RearSteeringState
from ev_msgs_py.contract.signals import TireForces
from ev_sim.steering_actuator.motor import SteeringMotorParameters, SteeringMotorState

PLANT = {"plant": "planar_rear_steering"}  # the others do not turn their rear wheels by it


@compilable
def shown(p: SteeringMotorParameters, s: SteeringMotorState) -> RearSteeringState:
    """Wheels and motor at this instant."""
    return RearSteeringState(s.angle, s.rate, p.gear_ratio * s.rate, s.torque, s.power)


@compilable
def moment_of_road(p: SteeringMotorParameters, tyres: TireForces) -> float:
    """Of the side forces, which act behind the steering axes by the trail and turn the wheels back [N m]."""
    return -p.trail * (tyres.lateral_force.rear_left + tyres.lateral_force.rear_right)
