"""Temperatures of a motor and its inverter."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import ParameterError, parameter


@dataclass(frozen=True, slots=True)
class ThermalParameters:
    """One heat capacity each for winding and inverter, cooled by one coolant."""

    coolant: float = parameter(40.0, unit="degC", low=-40.0, high=120.0, about="coolant inlet", source="assumption")
    coolant_flow: float = parameter(8.0, unit="l/min", low=0.1, high=31.0, about="of the coolant", source="assumption")
    winding_capacity: float = parameter(
        4000.0, unit="J/K", low=1.0, high=1e6, about="heat capacity of the winding", source="assumption"
    )
    winding_resistance: float = parameter(
        0.015, unit="K/W", low=1e-4, high=10.0, about="from winding to coolant", source="assumption"
    )
    inverter_capacity: float = parameter(
        1500.0, unit="J/K", low=1.0, high=1e6, about="heat capacity of the power stage", source="assumption"
    )
    inverter_resistance: float = parameter(
        0.02, unit="K/W", low=1e-4, high=10.0, about="from power stage to coolant", source="assumption"
    )
    winding_warm: float = parameter(
        120.0, unit="degC", low=-40.0, high=215.0, about="from here on the torque is derated", source="assumption"
    )
    winding_limit: float = parameter(
        140.0, unit="degC", low=-40.0, high=215.0, about="fault; no torque is left here", source="assumption"
    )
    inverter_warm: float = parameter(
        75.0, unit="degC", low=-40.0, high=215.0, about="from here on the torque is derated", source="assumption"
    )
    inverter_limit: float = parameter(
        90.0, unit="degC", low=-40.0, high=215.0, about="fault; no torque is left here", source="assumption"
    )

    def __post_init__(self) -> None:
        if self.winding_warm >= self.winding_limit or self.inverter_warm >= self.inverter_limit:
            raise ParameterError("winding_warm and inverter_warm must be below their limits")
