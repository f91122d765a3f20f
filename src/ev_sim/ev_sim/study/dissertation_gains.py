"""Gains of method 1 over the other four (dissertation, eqs 3.1, 5.1 and 5.2), by both denominators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


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
