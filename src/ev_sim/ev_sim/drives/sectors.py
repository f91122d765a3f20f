"""The Hall sectors of the rotor: where it stands in one, when it leaves it, and which phases then change their part."""

from __future__ import annotations

import math

from ev_msgs_py.compiling.compilable import compilable
from ev_sim.drives.state import SECTOR, DriveState


@compilable
def crossing_shape(sector: float, sector_angle: float) -> float:
    """EMF of the off phase over that of the flats: from 1 down to -1 in even sectors, up in odd ones."""
    falling = 1.0 - 2.0 * sector_angle / SECTOR
    return falling if int(sector) % 2 == 0 else -falling


@compilable
def time_to_edge(sector_angle: float, electrical_speed: float) -> float:
    """Time until the rotor enters the next sector [s]; infinite at rest."""
    if electrical_speed > 0.0:
        return (SECTOR - sector_angle) / electrical_speed
    if electrical_speed < 0.0:
        return sector_angle / -electrical_speed
    return math.inf


@compilable
def turned(sector_angle: float, electrical_speed: float, step: float, at_edge: bool) -> float:
    """Angle within the sector after a step [rad], exactly on the edge where the step was cut to end there."""
    if at_edge:
        return SECTOR if electrical_speed > 0.0 else 0.0
    return min(max(sector_angle + electrical_speed * step, 0.0), SECTOR)


@compilable
def enter_sector(s: DriveState, electrical_speed: float) -> None:
    """Commutate if the rotor stands on the edge that it moves across: one phase takes over from the off phase.

    Between an even sector and the next one high stays, between an odd one and the next low stays.
    """
    if electrical_speed > 0.0 and s.sector_angle >= SECTOR:
        lower_sector = int(s.sector)
        s.sector = float((lower_sector + 1) % 6)
        s.sector_angle = 0.0
    elif electrical_speed < 0.0 and s.sector_angle <= 0.0:
        lower_sector = (int(s.sector) + 5) % 6
        s.sector = float(lower_sector)
        s.sector_angle = SECTOR
    else:
        return
    if lower_sector % 2 == 0:
        s.off_current = -(s.high_current + s.off_current)
    else:
        s.high_current, s.off_current = s.off_current, s.high_current
