"""Drive and total efficiencies of the dissertation's bench: tables 5.1 to 5.6."""

from __future__ import annotations

import statistics

from ev_sim.study import dissertation_tables as printed
from ev_sim.verdicts.check import Measure, Number, Shown
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import StudyCases
from ev_sim.verdicts.sources.dissertation.assumptions import BENCH, IMPOSED, NO_ROLLING
from ev_sim.verdicts.sources.dissertation.runs import FIVE_ON_BENCH, SPEEDS, ByMethod, mean, order, seeds
from ev_sim.verdicts.tolerance import absolute

_DRIVER = "imposed_speed"
_LOSSES = "loss model of the machine and its inverter (no map is left in the source)"
_ASSUMED = f"{BENCH}; {IMPOSED}; {_LOSSES}"
_UNKNOWN = absolute(0.02, "losses of the bench are unknown")
_POINTS = absolute(2.0, "losses of the bench are unknown")


def _side(method: int, side: str, value: float) -> Declaration:
    quantity = f"drive_efficiency_{side}"
    return judged(
        f"diss.t5.{method}.drive.{side}",
        FIVE_ON_BENCH,
        Number("1", value, _UNKNOWN, mean(quantity, method, _DRIVER)),
        Shown("1", mean(quantity, method, "pulse"), "with driver pulse"),
        assumption=_ASSUMED,
    )


def _total(method: int, wheel: str) -> Measure:
    """Mean over the roads of wheel times drive efficiency [%]."""

    def measure(driven: StudyCases) -> float:
        of = (seeds(driven, quantity, method, _DRIVER) for quantity in (wheel, "drive_efficiency"))
        return 100.0 * statistics.fmean(a * b for a, b in zip(*of, strict=True))

    return measure


def _table(method: int) -> tuple[Declaration, ...]:
    return (
        _side(method, "right", printed.DRIVE_EFFICIENCY_RIGHT[method]),
        _side(method, "left", printed.DRIVE_EFFICIENCY_LEFT[method]),
        judged(
            f"diss.t5.6.drive.m{method}",
            FIVE_ON_BENCH,
            Number(
                "%",
                100.0 * printed.DRIVE_EFFICIENCY[method],
                _POINTS,
                mean("drive_efficiency", method, _DRIVER, 0.01),
            ),
            Shown("%", mean("drive_efficiency", method, "pulse", 0.01), "with driver pulse"),
            assumption=_ASSUMED,
        ),
        judged(
            f"diss.t5.6.total.m{method}",
            FIVE_ON_BENCH,
            Number(
                "%",
                100.0 * printed.TOTAL_EFFICIENCY[method],
                absolute(3.0, "follows wheel and drive efficiency"),
                _total(method, SPEEDS),
            ),
            Shown("%", _total(method, "wheel_efficiency"), "eq 2.37 in full"),
            assumption=f"{_ASSUMED}; {NO_ROLLING}",
        ),
    )


def _drive_order(of: ByMethod) -> bool:
    return of[1] > of[4] > of[3] > of[2] > of[5]


def _total_order(of: ByMethod) -> bool:
    return of[1] > of[4] > of[3] > of[5] > of[2]


def _beyond_the_product(method: int) -> Number:
    product = 100.0 * printed.BENCH_WHEEL_EFFICIENCY[method] * printed.DRIVE_EFFICIENCY[method]
    value = 100.0 * printed.TOTAL_EFFICIENCY[method]
    return Number("%", value, absolute(0.01, "two digits of three numbers"), lambda: product, f"method {method}")


DECLARATIONS: tuple[Declaration, ...] = (
    *(declaration for method in printed.DRIVE_EFFICIENCY for declaration in _table(method)),
    judged(
        "diss.t5.6.drive.order",
        FIVE_ON_BENCH,
        order("drive_efficiency", _DRIVER, _drive_order),
        assumption=_ASSUMED,
    ),
    judged(
        "diss.t5.6.total.order",
        FIVE_ON_BENCH,
        order("total_efficiency", _DRIVER, _total_order),
        assumption=_ASSUMED,
    ),
    judged(
        "diss.eq2.39.product",
        (),
        *(_beyond_the_product(method) for method in printed.TOTAL_EFFICIENCY),
        inputs="arithmetic of table 5.6 alone, not of our runs",
    ),
)
