"""Coolant loop of the buffer battery on the bench: cells, pump, radiator and fan (figure 4.8).

The dissertation names these parts, and a loop of its own with sensors of temperature and flow
(section 4.2). It prints no number of them and no rule for the fan, so all of these are assumptions.

How it works: the cells warm by the loss of the battery's resistance. The pump takes their heat to
the radiator; its fan runs between two temperatures of the coolant. The coolant has no heat
capacity of its own (that of 206 cells is 515 kJ/K, of 5 l of water with glycol 19 kJ/K), so its
temperatures follow from those of cells and air at once.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import (
    BatteryCoolant,
    Car,
    ParameterError,
    compilable,
    entry,
    exp,
    inlined,
    parameter,
)
from ev_sim.drives.electrical_side import COOLANT, heated

_ASSUMED = "assumption: not printed"


@dataclass(frozen=True, slots=True)
class BatteryLoopParameters:
    """Pump, radiator and fan; the air is at the cells' `ambient`."""

    flow: float = parameter(
        8.0, unit="l/min", low=0.1, high=100.0, about="of the pump", source=_ASSUMED
    )
    cell_resistance: float = parameter(
        1.0, unit="K/W", low=1e-3, high=1e3, about="from a cell to the coolant", source=_ASSUMED
    )
    radiator: float = parameter(
        50.0, unit="W/K", low=0.1, high=1e5, about="from coolant to air", source=_ASSUMED
    )
    radiator_with_fan: float = parameter(
        250.0, unit="W/K", low=0.1, high=1e5, about="the same while the fan runs", source=_ASSUMED
    )
    fan_on: float = parameter(
        35.0,
        unit="degC",
        low=-40.0,
        high=100.0,
        about="coolant out of the battery at which the fan starts",
        source=_ASSUMED,
    )
    fan_off: float = parameter(
        30.0, unit="degC", low=-40.0, high=100.0, about="at which it stops", source=_ASSUMED
    )

    def __post_init__(self) -> None:
        if self.fan_off >= self.fan_on:
            raise ParameterError(
                f"fan_off is {self.fan_off:g} degC, expected below fan_on, {self.fan_on:g} degC"
            )


@dataclass(slots=True)
class BatteryLoopState:
    """Cells and fan."""

    rise: float = entry(unit="K", about="of the cells above the air")
    fan: float = entry(unit="1", about="1 while it runs")


@inlined
def _warmed(p: BatteryLoopParameters, car: Car, s: BatteryLoopState) -> tuple[float, float]:
    """Rises above the air of the coolant into and out of the battery, over that of the cells [1].

    In the battery it comes closer to the cells by exp(-n/(R G)), in the radiator to the air by
    exp(-K/G), with G the heat that its flow carries for each kelvin. Source: both are heat
    exchangers with one side at an even temperature (VDI Heat Atlas, 2nd ed. 2010, chapter C1).
    """
    carried = p.flow / COOLANT
    to_air = p.radiator_with_fan if s.fan == 1.0 else p.radiator
    from_cells = exp(-car.battery.cells.in_series / (p.cell_resistance * carried))
    in_radiator = exp(-to_air / carried)
    out = (1.0 - from_cells) / (1.0 - from_cells * in_radiator)
    return out * in_radiator, out


@compilable
def coolant_of_battery(
    p: BatteryLoopParameters, car: Car, s: BatteryLoopState, cooling: float
) -> BatteryCoolant:
    """Flow and temperatures of the battery's coolant.

    Without `cooling` (0) it stands, as warm as the cells.
    """
    cells = car.battery.cells
    if cooling == 0.0:
        warm = cells.ambient + s.rise
        return BatteryCoolant(0.0, warm, warm)
    into, out = _warmed(p, car, s)
    return BatteryCoolant(p.flow, cells.ambient + s.rise * into, cells.ambient + s.rise * out)


@compilable
def advance_battery(
    p: BatteryLoopParameters,
    car: Car,
    s: BatteryLoopState,
    cooling: float,
    current: float,
    period: float,
) -> None:
    """Warm the cells by a current [A] of the battery over a period [s], exactly."""
    cells = car.battery.cells
    out = coolant_of_battery(p, car, s, cooling).coolant_out
    if out >= p.fan_on:
        s.fan = 1.0
    elif out <= p.fan_off:
        s.fan = 0.0
    loss = car.battery.resistance * current * current / cells.in_series
    # Straight into the air as well, as in a battery without a loop.
    into, warmed = _warmed(p, car, s)
    taken = cooling * (warmed - into) * p.flow / COOLANT / cells.in_series
    conductance = 1.0 / cells.thermal_resistance + taken
    left = exp(-period * conductance / cells.heat_capacity)
    s.rise = heated(s.rise, loss, 1.0 / conductance, left)
