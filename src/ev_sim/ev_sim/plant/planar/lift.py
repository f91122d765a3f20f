"""Wheels that leave the ground, and what the planar plant says about its run."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.commands import guard_notes
from ev_sim.plant.planar.loads import loads
from ev_sim.plant.planar.road_under_wheels import RoadTables, gravity_at
from ev_sim.plant.planar.state import BODY_DISTANCE, PlanarState


@inlined
def note_lifted(s: PlanarState, car: Car, road: RoadTables) -> None:
    """Keep which wheels are off the ground in this state."""
    _, _, gravity_z = gravity_at(road.slope, s.motion[BODY_DISTANCE])
    load = loads(s.motion, car, gravity_z)
    for i in range(4):
        if load[i] == 0.0:
            s.lifted[i] = 1.0


def notes(s: PlanarState) -> tuple[str, ...]:
    """Commands that were not taken as they came, counted by powers of ten, and wheels that have left the ground."""
    lifted = (f"{name} wheel left the ground" for name, was in zip(WHEEL_NAMES, s.lifted, strict=True) if was)
    return (*guard_notes(s.guard), *lifted)
