"""The planar plant with rear wheels that are steered by a part of their own."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.contract.actuator_signals import RearSteeringState
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.commands import accepted
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.plant import PLANAR, planar
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.state import PlanarState


@method("plant", "planar_rear_steering", PlanarParameters, **PLANAR)
@inlined
def planar_rear_steering(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    rear: RearSteeringState,
) -> None:
    """The planar plant with rear wheels that an actuator steers, besides what `rear_steering_ratio` of the car says.

    Over a period the rear angle goes on at its rate, as the front one does, within the same limit.
    """
    limit = c.limits.angle
    s.rear_angle = accepted(s.guard, rear.angle, s.rear_angle, -limit, limit)
    s.rear_rate = accepted(s.guard, rear.rate, 0.0, (-limit - s.rear_angle) / period, (limit - s.rear_angle) / period)
    planar(p, car, c, s, period, command, column)
    s.rear_angle += s.rear_rate * period
