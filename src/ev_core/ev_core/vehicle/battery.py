"""The traction battery of a vehicle and its cells."""

from dataclasses import dataclass
from functools import partial

from ev_core.parameters.declaration import group, own, parameter, setting
from ev_msgs_py.refusal import ParameterError

_of_cell = partial(
    parameter,
    source="assumption for a Winston WB-LYP60AHA, whose data are lost in the dissertation (figure "
    "4.8)",
)


@dataclass(frozen=True, slots=True)
class Cells:
    """Equal cells in series, of a plant with its electrical side.

    Their charge is the battery's `capacity`.
    """

    in_series: int = setting(
        150,
        unit="1",
        low=1,
        high=1000,
        about="cells; by default those whose 3.2 V make the 480 V of `open_circuit_voltage`",
    )
    open_circuit_voltage: tuple[float, ...] = parameter(
        (2.80, 3.12, 3.18, 3.20, 3.21, 3.22, 3.23, 3.24, 3.25, 3.27, 3.36),
        unit="V",
        low=0.5,
        high=6.0,
        about="of a cell, at equally spaced states of charge from empty to full",
        source="assumption: shape of LiFePO4, mean 3.2 V",
    )
    resistance: float = _of_cell(
        1e-3, unit="ohm", low=1e-7, high=1.0, about="in series with a cell, at once"
    )
    relaxation_resistance: float = _of_cell(
        5e-4, unit="ohm", low=0.0, high=1.0, about="of a cell, added in the course of time"
    )
    relaxation_time: float = _of_cell(
        30.0, unit="s", low=0.1, high=1e5, about="time constant of that"
    )
    discharge_current: float = _of_cell(
        490.0, unit="A", low=0.0, high=1e5, about="largest, at a good temperature"
    )
    charge_current: float = _of_cell(
        180.0, unit="A", low=0.0, high=1e5, about="largest, at a good temperature"
    )
    ambient: float = parameter(
        25.0, unit="degC", low=-40.0, high=60.0, about="of the cells at the start, and around them"
    )
    heat_capacity: float = parameter(
        2500.0, unit="J/K", low=1.0, high=1e6, about="of a cell", source="assumption for 2.5 kg"
    )
    thermal_resistance: float = parameter(
        2.0, unit="K/W", low=1e-3, high=1e3, about="from a cell to what is around it"
    )
    discharge_temperature: tuple[float, ...] = parameter(
        (-30.0, 0.0, 45.0, 60.0),
        unit="degC",
        low=-60.0,
        high=120.0,
        about="no current at the first and the last, all of it between the middle two, linear "
        "between",
        source="assumption, usual for LiFePO4",
    )
    charge_temperature: tuple[float, ...] = parameter(
        (0.0, 10.0, 45.0, 60.0),
        unit="degC",
        low=-60.0,
        high=120.0,
        about="the same while charging",
        source="assumption, usual for LiFePO4",
    )

    def __post_init__(self) -> None:
        if len(self.open_circuit_voltage) < 2:
            raise ParameterError("open_circuit_voltage needs at least two elements")
        for name in ("discharge_temperature", "charge_temperature"):
            four = getattr(self, name)
            if len(four) != 4 or not four[0] < four[1] <= four[2] < four[3]:
                raise ParameterError(f"{name} needs four elements that rise")


@dataclass(frozen=True, slots=True)
class Battery:
    """The traction battery: open-circuit voltage over charge, one resistance, limits; or cells."""

    open_circuit_voltage: tuple[float, ...] = own(
        (432.0, 468.0, 480.0, 492.0, 528.0),
        unit="V",
        low=10.0,
        high=2000.0,
        about="at equally spaced states of charge from empty to full",
    )
    resistance: float = own(0.1, unit="ohm", low=1e-6, high=10.0, about="internal resistance")
    capacity: float = own(
        50.0, unit="A h", low=0.1, high=1e4, about="charge between empty and full"
    )
    state_of_charge: float = setting(0.8, unit="1", low=0.0, high=1.0, about="at the start")
    discharge_power: float = setting(
        120e3, unit="W", low=0.0, high=1e7, about="largest power given"
    )
    charge_power: float = setting(60e3, unit="W", low=0.0, high=1e7, about="largest power taken")
    auxiliary_power: float = setting(
        0.0, unit="W", low=0.0, high=1e5, about="steady consumption besides the drives"
    )
    cells: Cells = group(Cells)

    def __post_init__(self) -> None:
        if len(self.open_circuit_voltage) < 2:
            raise ParameterError("open_circuit_voltage needs at least two elements")
