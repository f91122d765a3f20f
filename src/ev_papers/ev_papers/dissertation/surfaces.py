"""Surfaces of the dissertation: tables 2.2 and 2.3, their peaks, their shares of the road, and what they bound."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_papers.dissertation.runs import MODEL
from ev_sim.surfaces import SURFACES, RoadParameters, Surface, left_and_right
from ev_sim.verdicts.check import Number, absolute, relative
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns

_COEFFICIENTS = {  # table 2.3
    "dry_asphalt": (1.029, 17.16, 0.523),
    "wet_asphalt_1": (0.857, 33.822, 0.347),
    "wet_asphalt_2": (0.635, 41.915, 0.289),
    "packed_snow_1": (0.425, 51.348, 0.207),
    "packed_snow_2": (0.1946, 94.129, 0.0646),
    "ice": (0.05, 306.39, 0.0),
}
_RESISTANCES = {  # table 2.2
    "dry_asphalt": (0.0, 0.0),
    "wet_asphalt_1": (0.007, 0.015),
    "wet_asphalt_2": (0.007, 0.015),
    "packed_snow_1": (0.056, 0.086),
    "packed_snow_2": (0.056, 0.086),
    "ice": (0.004, 0.006),
}
_PEAKS = {  # slip and friction, of tables and eq 2.15 by a scan over a million slips
    "dry_asphalt": (0.2051, 0.8913),
    "wet_asphalt_1": (0.1308, 0.8013),
    "wet_asphalt_2": (0.1079, 0.5969),
    "packed_snow_1": (0.0907, 0.4022),
    "packed_snow_2": (0.0600, 0.1900),
}
_GIVEN = "ev_sim/surfaces.py has what is printed"
_EXACT = relative(0.0, "exact")
_SEEDS = range(1, 11)


def _of(name: str, quantity: str, value: float, measure: Callable[[Surface], float]) -> Number:
    return Number("1", value, _EXACT, lambda: measure(SURFACES[name]), f"{name.replace('_', ' ')} {quantity}")


def _coefficients(name: str) -> tuple[Number, ...]:
    c1, c2, c3 = _COEFFICIENTS[name]
    return (
        _of(name, "C1", c1, lambda of: of.c1),
        _of(name, "C2", c2, lambda of: of.c2),
        _of(name, "C3", c3, lambda of: of.c3),
    )


def _resistances(name: str) -> tuple[Number, Number]:
    least, largest = _RESISTANCES[name]
    return (
        _of(name, "least", least, lambda of: of.rolling_resistance_range[0]),
        _of(name, "largest", largest, lambda of: of.rolling_resistance_range[1]),
    )


def _slip_of_peak(of: Surface) -> float:
    return math.log(of.c1 * of.c2 / of.c3) / of.c2


def _peaks(name: str) -> tuple[Number, Number]:
    slip, friction = _PEAKS[name]
    rounding = absolute(1e-4, "four digits")
    title = name.replace("_", " ")
    return (
        Number("1", slip, rounding, lambda: _slip_of_peak(SURFACES[name]), f"{title} S*"),
        Number("1", friction, rounding, lambda: SURFACES[name].peak_friction, f"{title} phi*"),
    )


def _share_of_snow(side: int) -> Callable[[ScenarioRuns], float]:
    """Mean share of the length of one side over ten roads, as far as the cycle is long [1]."""

    def measure(driven: ScenarioRuns) -> float:
        given = {
            name.removeprefix("road."): value
            for name, value in driven.parameters["plant"].items()
            if name.startswith("road.")
        }
        shares = []
        for seed in _SEEDS:
            segments = left_and_right(RoadParameters(**{**given, "seed": seed}))[side]
            edges = np.clip([*segments.start, math.inf], 0.0, 4402.6)
            snow = [name.startswith("packed_snow") for name in segments.surface]
            shares.append(float(np.diff(edges)[snow].sum()) / 4402.6)
        return sum(shares) / len(shares)

    return measure


def _largest_efficiency(end: int, f_0: float) -> float:
    """Largest eq 2.37 of a wheel on wet asphalt 1 for 40 % of the time and on packed snow 1 for the rest [1].

    Both slips are free and the wheel is in equilibrium, M/(F r) = phi(S) + f; `end` of the range of table 2.2, -1 for
    its middle.
    """
    slips = np.linspace(0.002, 0.3, 300)
    torque, useful, speed = 0.0, 0.0, 0.0
    for share, name, axis in ((0.4, "wet_asphalt_1", (slice(None), None)), (0.6, "packed_snow_1", (None, slice(None)))):
        of = SURFACES[name]
        resistance = f_0 + (of.rolling_resistance if end < 0 else of.rolling_resistance_range[end])
        use = of.c1 * (1.0 - np.exp(-of.c2 * slips)) - of.c3 * slips
        useful = useful + share * use[axis]
        torque = torque + share * (use + resistance)[axis]
        speed = speed + share * (1.0 / (1.0 - slips))[axis]
    return float((useful / torque / speed).max())


_TWO_DIGITS = absolute(0.005, "two digits")

DECLARATIONS: tuple[Declaration, ...] = (
    judged("diss.t2.2", (), *(number for name in _RESISTANCES for number in _resistances(name)), inputs=_GIVEN),
    judged("diss.t2.3", (), *(number for name in _COEFFICIENTS for number in _coefficients(name)), inputs=_GIVEN),
    judged(
        "diss.peaks",
        (),
        *(number for name in _PEAKS for number in _peaks(name)),
        Number("1", 0.05, absolute(1e-4, "four digits"), lambda: SURFACES["ice"].peak_friction, "ice phi*, no S*"),
    ),
    judged(
        "diss.road.share",
        MODEL,
        Number("1", 0.6, absolute(0.05, "random lengths and surfaces"), _share_of_snow(0), "snow left"),
        Number("1", 0.6, absolute(0.05, "random lengths and surfaces"), _share_of_snow(1), "snow right"),
        assumption="segments of 5 to 50 m, evenly distributed",
    ),
    judged(
        "diss.bound.eq2.37",
        (),
        Number("1", 0.89, _TWO_DIGITS, lambda: _largest_efficiency(0, 0.0), "f_0 = 0, lower ends"),
        Number("1", 0.85, _TWO_DIGITS, lambda: _largest_efficiency(-1, 0.012), "f_0 = 0.012, middle"),
    ),
)
