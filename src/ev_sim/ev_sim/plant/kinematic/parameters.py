"""What the kinematic plant is told."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import parameter
from ev_sim.drives.drive import DriveParameters


@dataclass(frozen=True, slots=True)
class KinematicPlantParameters(DriveParameters):
    """Drives, supply and integration of the kinematic plant; the car itself is the vehicle description."""

    bus_voltage: float = parameter(
        480.0,
        unit="V",
        low=1.0,
        high=2000.0,
        about="constant voltage of the bus; assumed, the paper's second turn needs more than the 381 V of the EMF",
    )
    sub_step: float = parameter(
        1e-3, unit="s", low=1e-6, high=1e-3, about="longest step of the motion, over which the drives see one speed"
    )
    initial_speed: float = parameter(0.0, unit="m/s", low=-100.0, high=100.0, about="speed at the start")
