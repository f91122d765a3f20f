"""What the faults of the car do now, and what they remember."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.record import entry, per_wheel, series
from ev_sim.plant.planar.faults.parameters import LONGEST_DELAY


@dataclass(slots=True)
class FaultState:
    """As it is without faults; `is_struck` says whether anything else is to be looked at."""

    is_struck: float = entry(unit="1", about="1 while there are faults")
    share: list[float] = per_wheel(1.0, unit="1", about="of its torque that the motor gives")
    stuck: list[float] = per_wheel(unit="1", about="1 while the torque is stuck")
    stuck_torque: list[float] = per_wheel(unit="N m", about="of the motor, at its shaft")
    trips_at: list[float] = per_wheel(unit="N m", about="asked for at the shaft; 0: never")
    tripped: list[float] = per_wheel(unit="1", about="1 once the inverter has switched off")
    delay: list[float] = per_wheel(unit="1", about="control periods until the inverter gets its command")
    hall: list[float] = per_wheel(unit="1", about="1 while a Hall sensor is stuck")
    power: float = entry(1.0, unit="1", about="share of the battery's power limits")
    flat: list[float] = per_wheel(unit="1", about="share of the air that is lost")
    asked: list[float] = series(4 * LONGEST_DELAY, unit="N m", about="last drive torques, wheel by wheel")
