"""The tables of the dissertation by method, and gains of method 1 over the other four (eqs 3.1, 5.1 and 5.2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ev_sim.verdicts.sources import published_value

_METHODS = range(1, 6)


def _table(id: str, unit: float = 1.0) -> dict[int, float]:
    """By method what published.csv has of an id, in which it is written as {}, in multiples of a unit."""
    return {method: published_value("dissertation", id.format(method)) * unit for method in _METHODS}


# Table 3.6. Tables 3.1 to 3.5 have right and left, and tables 5.1 to 5.5 the same numbers again, but no mean.
WHEEL_EFFICIENCY = _table("diss.t3.6.m{}.mean")

# Table 5.6, printed in per cent, and the energy as kWh.
BENCH_WHEEL_EFFICIENCY = _table("diss.t5.6.wheel.m{}", 0.01)
DRIVE_EFFICIENCY = _table("diss.t5.6.drive.m{}", 0.01)
TOTAL_EFFICIENCY = _table("diss.t5.6.total.m{}", 0.01)
ENERGY = _table("diss.t5.6.energy.m{}")

KILOWATT_MINUTE = 60e3  # [J]; 99.66 kWh in 580 s would be 619 kW
KILOWATT_HOUR = 3.6e6  # [J]


class Gains(NamedTuple):
    """Gains of method 1 over each other method [%]: over the efficiency of method 1, and over that of the other one.

    Eqs 3.1 and 5.2 are printed with the first denominator. Eq 5.1 is printed with the second, yet the range printed for
    it comes from the first.
    """

    over_method_1: dict[int, float]
    over_the_other: dict[int, float]


def gains(efficiency: Mapping[int, float]) -> Gains:
    """The gains of efficiencies [1] by number of the method, above zero."""
    best = efficiency[1]
    others = {method: value for method, value in efficiency.items() if method != 1}
    return Gains(
        {method: 100.0 * (best - value) / best for method, value in others.items()},
        {method: 100.0 * (best - value) / value for method, value in others.items()},
    )


def savings(energy: Mapping[int, float]) -> dict[int, float]:
    """What method 1 saves, E_i - E_1, by number of the other method, in the unit of the energies."""
    return {method: value - energy[1] for method, value in energy.items() if method != 1}
