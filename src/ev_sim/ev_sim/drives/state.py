"""What a drive keeps from step to step, in every depth of detail."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.contract.record import entry

SECTOR = math.pi / 3.0  # width of a Hall sector, as an electrical angle [rad]


@dataclass(slots=True)
class DriveState:
    """One drive; it starts without current in the middle of a Hall sector."""

    torque: float = entry(unit="N m", about="electromagnetic, at the shaft, now")
    current: float = entry(unit="A", about="in at one phase and out at another, now")
    mean_torque: float = entry(unit="N m", about="over the last advance")
    electrical_power: float = entry(unit="W", about="from the bus, mean over the last advance")
    voltage_integral: float = entry(unit="V", about="of the PI current control")
    high_current: float = entry(unit="A", about="switched: into the phase on its positive EMF flat")
    off_current: float = entry(unit="A", about="switched: into the phase that is switched off")
    voltage_sign: float = entry(
        1.0, unit="1", about="switched: 1 with the high phase on the upper rail, -1 on the lower"
    )
    sector_angle: float = entry(
        SECTOR / 2.0, unit="rad", about="switched: electrical, from the lower edge of the sector"
    )
    sector: float = entry(unit="1", about="switched: Hall sector, 0 to 5")
