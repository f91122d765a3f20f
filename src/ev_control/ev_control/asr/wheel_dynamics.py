"""The spinning wheel as traction control sees it: its inertia, and the torque that the road takes from it."""

from __future__ import annotations

from ev_control.asr.traction_control import WheelMotion
from ev_msgs_py.vehicle import Vehicle


def mass_share(vehicle: Vehicle) -> float:
    """The part of the car's mass that one driven wheel has to move [kg]; the source's M is that of a single wheel."""
    return vehicle.mass / max(len(set(vehicle.driven_wheels)), 1)


def road_torque(motion: WheelMotion, inertia: float) -> float:
    """Torque that the road takes from a wheel, M - J w' [N m], mean over the last period, not filtered."""
    return motion.torque - inertia * motion.acceleration
