"""What the kinematic plant keeps from step to step, and how it starts."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.record import each_wheel, entry, part
from ev_sim.drives.state import DriveState
from ev_sim.plant.commands import GuardState, guard_notes
from ev_sim.plant.kinematic.parameters import KinematicPlantParameters


@dataclass(slots=True)
class RollingWheelState:
    """A wheel that rolls without slip."""

    position: float = entry(unit="rad", about="turned angle")
    speed_ratio: float = entry(1.0, unit="1", about="speed of the wheel over that of the centre of mass, V_j/V")
    mean_torque: float = entry(unit="N m", about="of the drive at the wheel, over the last control period")


@dataclass(slots=True)
class KinematicPlantState:
    """The car on its path, its wheels and drives, and the commands that were accepted last."""

    speed: float = entry(unit="m/s", about="V, of the centre of mass along its path, backwards negative")
    acceleration: float = entry(unit="m/s^2", about="along the path, mean over the last control period")
    path_curvature: float = entry(unit="1/m", about="1/R, positive to the left")
    course_offset: float = entry(unit="rad", about="from the car's x axis to the path, left positive")
    x: float = entry(unit="m", about="of the centre of mass in odom")
    y: float = entry(unit="m", about="of the centre of mass in odom")
    heading: float = entry(unit="rad", about="of the car in odom")
    wheels: list[RollingWheelState] = each_wheel(RollingWheelState)
    drives: list[DriveState] = each_wheel(DriveState)
    guard: GuardState = part(GuardState)


def rolling_straight(p: KinematicPlantParameters) -> KinematicPlantState:
    """The car at its initial speed."""
    return KinematicPlantState(speed=p.initial_speed)


def notes(s: KinematicPlantState) -> tuple[str, ...]:
    """Commands that were not taken as they came."""
    return guard_notes(s.guard)
