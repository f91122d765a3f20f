"""The traction battery of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import ParameterError, group, parameter
from ev_msgs_py.vehicle.cells import Cells


@dataclass(frozen=True, slots=True)
class Battery:
    """The traction battery: open-circuit voltage over charge, one resistance, limits; or cells."""

    open_circuit_voltage: tuple[float, ...] = parameter(
        (432.0, 468.0, 480.0, 492.0, 528.0),
        unit="V",
        low=10.0,
        high=2000.0,
        about="at equally spaced states of charge from empty to full",
        own=True,
    )
    resistance: float = parameter(0.1, unit="ohm", low=1e-6, high=10.0, about="internal resistance", own=True)
    capacity: float = parameter(50.0, unit="A h", low=0.1, high=1e4, about="charge between empty and full", own=True)
    state_of_charge: float = parameter(0.8, unit="1", low=0.0, high=1.0, about="at the start")
    discharge_power: float = parameter(120e3, unit="W", low=0.0, high=1e7, about="largest power given")
    charge_power: float = parameter(60e3, unit="W", low=0.0, high=1e7, about="largest power taken")
    auxiliary_power: float = parameter(0.0, unit="W", low=0.0, high=1e5, about="steady consumption besides the drives")
    cells: Cells = group(Cells)

    def __post_init__(self) -> None:
        if len(self.open_circuit_voltage) < 2:
            raise ParameterError("open_circuit_voltage needs at least two elements")
