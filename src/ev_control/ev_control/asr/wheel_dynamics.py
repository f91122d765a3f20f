"""The spinning wheel as traction control sees it: its inertia, and the torque that the road takes from it."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.asr.traction_control import WheelMotion
from ev_msgs_py.vehicle import Vehicle


def mass_share(vehicle: Vehicle) -> float:
    """The part of the car's mass that one driven wheel has to move [kg]; the source's M is that of a single wheel."""
    return vehicle.mass / max(len(set(vehicle.driven_wheels)), 1)


def filter_share(period: float, time_constant: float) -> float:
    """Share of the gap that a first-order filter closes in one period, by implicit Euler [1]."""
    return period / (period + time_constant)


@dataclass(slots=True)
class Filtered:
    """A number behind a first-order filter; the first one passes."""

    value: float | None = None

    def follow(self, value: float, share: float) -> float:
        """The filtered number, a share of the gap nearer to this one."""
        self.value = value if self.value is None else self.value + share * (value - self.value)
        return self.value


def road_torque(motion: WheelMotion, inertia: float) -> float:
    """Torque that the road takes from a wheel, M - J w' [N m], mean over the last period, not filtered."""
    return motion.torque - inertia * motion.acceleration
