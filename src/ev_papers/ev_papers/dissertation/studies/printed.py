"""Gains of method 1 over the other four (dissertation, eqs 3.1, 5.1 and 5.2), by both denominators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

# Tables 3.1 to 3.5, and the same numbers again in tables 5.1 to 5.5, which print no mean.
WHEEL_EFFICIENCY_RIGHT = {1: 0.96, 2: 0.79, 3: 0.90, 4: 0.90, 5: 0.86}
WHEEL_EFFICIENCY_LEFT = {1: 0.96, 2: 0.79, 3: 0.90, 4: 0.90, 5: 0.83}
WHEEL_EFFICIENCY = {1: 0.96, 2: 0.79, 3: 0.90, 4: 0.90, 5: 0.85}  # mean, table 3.6

DRIVE_EFFICIENCY_RIGHT = {1: 0.68, 2: 0.61, 3: 0.61, 4: 0.64, 5: 0.55}  # tables 5.1 to 5.5
DRIVE_EFFICIENCY_LEFT = {1: 0.70, 2: 0.61, 3: 0.62, 4: 0.69, 5: 0.61}

# Table 5.6, printed in per cent.
BENCH_WHEEL_EFFICIENCY = {1: 0.9595, 2: 0.7869, 3: 0.8960, 4: 0.8954, 5: 0.8437}
DRIVE_EFFICIENCY = {1: 0.6848, 2: 0.6083, 3: 0.6110, 4: 0.6657, 5: 0.5798}
TOTAL_EFFICIENCY = {1: 0.6571, 2: 0.4787, 3: 0.5475, 4: 0.5961, 5: 0.4892}
ENERGY = {1: 99.66, 2: 107.28, 3: 107.01, 4: 101.56, 5: 110.12}  # printed as kWh

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
