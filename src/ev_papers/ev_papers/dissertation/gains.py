"""Gains of method 1 in the dissertation, eqs 3.1, 5.1 and 5.2: arithmetic of its tables, and what our runs have."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ev_papers.dissertation.assumptions import BENCH, IMPOSED, NO_ROLLING, ROAD
from ev_papers.dissertation.runs import FIVE_METHODS, FIVE_ON_BENCH, SPEEDS, means
from ev_papers.dissertation.studies import printed as printed
from ev_papers.dissertation.studies.printed import gains, savings
from ev_sim.verdicts.check import Number, Shown, absolute
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import StudyCases

_DRIVER = "imposed_speed"
_TABLES = absolute(0.1, "one digit, of rounded tables")
_RUNS = absolute(3.0, "bands of the efficiencies")
_ARITHMETIC = "arithmetic of table 5.6 alone; what our own runs have stands beside"

End = Callable[[Mapping[int, float]], float]


def _smallest(of: Mapping[int, float]) -> float:
    return min(of.values())


def _largest(of: Mapping[int, float]) -> float:
    return max(of.values())


_ENDS: tuple[tuple[str, End], ...] = (("smallest", _smallest), ("largest", _largest))


def _of_tables(efficiency: Mapping[int, float], ends: tuple[float, float]) -> tuple[Number, ...]:
    of = gains(efficiency).over_method_1
    return tuple(
        Number("%", value, _TABLES, lambda *driven, end=end: end(of), f"{name}, of the tables")
        for value, (name, end) in zip(ends, _ENDS, strict=True)
    )


def _own(quantity: str, end: End) -> Callable[[StudyCases], float]:
    return lambda driven: end(gains(means(driven, quantity, _DRIVER)).over_method_1)


def _of_runs(quantity: str, ends: tuple[float, float]) -> tuple[Number, ...]:
    return tuple(
        Number("%", value, _RUNS, _own(quantity, end), f"{name}, of our runs")
        for value, (name, end) in zip(ends, _ENDS, strict=True)
    )


def _own_shown(quantity: str) -> tuple[Shown, ...]:
    return tuple(Shown("%", _own(quantity, end), f"{name}, of our runs") for name, end in _ENDS)


def _other_denominator(efficiency: Mapping[int, float]) -> tuple[Shown, ...]:
    of = gains(efficiency).over_the_other
    return tuple(
        Shown("%", lambda *driven, end=end: end(of), f"{name} over eta_i, of the tables") for name, end in _ENDS
    )


def _saved(end: End) -> Callable[[StudyCases], float]:
    return lambda driven: end(savings(means(driven, "energy_windows", "pulse"))) / printed.KILOWATT_MINUTE


_SAVED = savings(printed.ENERGY)
_ASSUMED = f"{IMPOSED}; {NO_ROLLING}; {ROAD}"

DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.gain.3.1.theory",
        FIVE_METHODS,
        *_of_tables(printed.WHEEL_EFFICIENCY, (6.2, 17.7)),
        *_of_runs(SPEEDS, (6.2, 17.7)),
        *_other_denominator(printed.WHEEL_EFFICIENCY),
        assumption=_ASSUMED,
    ),
    judged(
        "diss.gain.3.1.bench",
        FIVE_ON_BENCH,
        *_of_tables(printed.BENCH_WHEEL_EFFICIENCY, (6.6, 18.0)),
        *_of_runs(SPEEDS, (6.6, 18.0)),
        *_other_denominator(printed.BENCH_WHEEL_EFFICIENCY),
        assumption=f"{_ASSUMED}; {BENCH}",
    ),
    judged(
        "diss.gain.5.1",
        FIVE_ON_BENCH,
        *_of_tables(printed.DRIVE_EFFICIENCY, (2.8, 15.3)),
        *_other_denominator(printed.DRIVE_EFFICIENCY),
        *_own_shown("drive_efficiency"),
        inputs=f"{_ARITHMETIC}; with the denominator eta_1, as eq 5.1 is printed, over eta_i, it is not reproduced",
    ),
    judged(
        "diss.gain.5.2",
        FIVE_ON_BENCH,
        *_of_tables(printed.TOTAL_EFFICIENCY, (9.3, 27.1)),
        *_other_denominator(printed.TOTAL_EFFICIENCY),
        *_own_shown("total_efficiency"),
        inputs=_ARITHMETIC,
    ),
    judged(
        "diss.gain.energy",
        FIVE_ON_BENCH,
        *(
            Number("kWh", value, _TABLES, lambda *driven, end=end: end(_SAVED), f"{name}, of the table")
            for value, (name, end) in zip((1.9, 10.5), _ENDS, strict=True)
        ),
        *(Shown("kW min", _saved(end), f"{name}, of our runs with driver pulse") for name, end in _ENDS),
        inputs=_ARITHMETIC,
    ),
)
