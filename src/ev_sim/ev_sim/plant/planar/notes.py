"""What the planar plant says about its run: wheels off the ground, an empty battery, a refused gear, commands."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.commands import guard_notes
from ev_sim.plant.planar.loads import loads
from ev_sim.plant.planar.road_under_wheels import RoadTables, gravity_at
from ev_sim.plant.planar.state import BODY_DISTANCE, PlanarState

_REFUSED = (
    "more torque was asked against the gear than the engine's drag: the gear stayed, the selector moves below "
    "vehicle.engine.gearbox.selector_speed"
)


@inlined
def keep_noted(s: PlanarState, car: Car, road: RoadTables) -> None:
    """Keep which wheels are off the ground in this state, and whether the battery is empty."""
    if s.state_of_charge <= 0.0:
        s.battery_empty = 1.0
    _, _, gravity_z = gravity_at(road.slope, s.motion[BODY_DISTANCE])
    load = loads(s.motion, car, gravity_z)
    for i in range(4):
        if load[i] == 0.0:
            s.lifted[i] = 1.0


def notes(s: PlanarState) -> tuple[str, ...]:
    """Commands that were not taken as they came, counted by powers of ten, and what has happened at least once."""
    lifted = (f"{name} wheel left the ground" for name, was in zip(WHEEL_NAMES, s.lifted, strict=True) if was)
    empty = ("the battery was empty: no drive torque from it",) if s.battery_empty else ()
    refused = (_REFUSED,) if s.engine.refused else ()
    return (*guard_notes(s.guard), *lifted, *empty, *refused)
