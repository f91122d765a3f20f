"""Wheel efficiencies of the dissertation: tables 3.1 to 3.6, and on the bench."""

from __future__ import annotations

from ev_sim.report.metric import Band
from ev_sim.study import dissertation_tables as printed
from ev_sim.verdicts.check import Measure, Number, Shown
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import StudyCases
from ev_sim.verdicts.sources.dissertation.assumptions import IMPOSED, NO_ROLLING, ROAD, wheel_efficiency
from ev_sim.verdicts.sources.dissertation.runs import (
    FIVE_METHODS,
    FIVE_ON_BENCH,
    SPEEDS,
    ByMethod,
    mean,
    means,
    order,
    order_shown,
)
from ev_sim.verdicts.tolerance import Tolerance, absolute, between

_DRIVER = "imposed_speed"
_BANDS: dict[int, tuple[Band, str]] = {
    1: ((0.94, 0.97), "spread over k, snow 1 or 2, lengths of the segments"),
    2: ((0.74, 0.81), "the same"),
    3: ((0.86, 0.93), "the same"),
    4: ((0.85, 0.92), "the same, and the law of K"),
    5: ((0.82, 0.88), "the same; it takes a friction that is overestimated"),
}


def band(method: int, factor: float = 1.0) -> Tolerance:
    """In which a wheel efficiency counts as the printed one."""
    (low, high), why = _BANDS[method]
    return between(factor * low, factor * high, why)


def _row(id: str, method: int, value: float, row: str, bench: bool = False, unit: str = "1") -> Declaration:
    """One number of a table: `row` is right, left or empty for the mean; in per cent if that is the unit."""
    ending, percent = f"_{row}" if row else "", 0.01 if unit == "%" else 1.0
    full = mean(f"wheel_efficiency{ending}", method, _DRIVER, percent)
    pulse = mean(f"wheel_efficiency{ending}", method, "pulse", percent)
    return judged(
        id,
        FIVE_ON_BENCH if bench else FIVE_METHODS,
        Number(unit, value, band(method, 1 / percent), mean(f"{SPEEDS}{ending}", method, _DRIVER, percent)),
        Shown(unit, full, "eq 2.37 in full"),
        Shown(unit, pulse, "in full with driver pulse"),
        assumption=wheel_efficiency(method, bench),
    )


def _table(method: int) -> tuple[Declaration, ...]:
    right, left = printed.WHEEL_EFFICIENCY_RIGHT[method], printed.WHEEL_EFFICIENCY_LEFT[method]
    return (
        _row(f"diss.t3.{method}.right", method, right, "right"),
        _row(f"diss.t3.{method}.left", method, left, "left"),
        _row(f"diss.t3.6.m{method}.mean", method, printed.WHEEL_EFFICIENCY[method], ""),
        _row(f"diss.t5.{method}.wheel.right", method, right, "right", bench=True),
        _row(f"diss.t5.{method}.wheel.left", method, left, "left", bench=True),
        _row(
            f"diss.t5.6.wheel.m{method}",
            method,
            100.0 * printed.BENCH_WHEEL_EFFICIENCY[method],
            "",
            bench=True,
            unit="%",
        ),
    )


def _gap(driven: StudyCases) -> float:
    found = means(driven, SPEEDS, _DRIVER)
    return found[1] - found[2]


def _in_order(of: ByMethod) -> bool:
    return of[1] > of[3] >= of[4] > of[5] > of[2]


def _in_order_without_5(of: ByMethod) -> bool:
    return of[1] > of[3] >= of[4] > of[2]


def _right_minus_left(method: int) -> Measure:
    right, left = (mean(f"{SPEEDS}_{side}", method, _DRIVER) for side in ("right", "left"))
    return lambda driven: right(driven) - left(driven)


def _difference(method: int) -> Number:
    why = "both sides have the same statistics; ten roads leave so much"
    return Number("1", 0.0, absolute(0.02, why), _right_minus_left(method), f"method {method}")


_COMMON = f"{IMPOSED}; {NO_ROLLING}; {ROAD}"

DECLARATIONS: tuple[Declaration, ...] = (
    *(declaration for method in printed.WHEEL_EFFICIENCY for declaration in _table(method)),
    judged(
        "diss.t3.6.order",
        FIVE_METHODS,
        order(SPEEDS, _DRIVER, _in_order),
        order_shown(SPEEDS, _DRIVER, _in_order_without_5, "without method 5"),
        assumption=_COMMON,
    ),
    judged(
        "diss.t3.6.gap",
        FIVE_METHODS,
        Number("1", 0.17, between(0.14, 0.20, "as far as lengths and snow leave it open"), _gap),
        assumption=f"{_COMMON}; asr.use 0.95",
    ),
    judged(
        "diss.left_right",
        FIVE_METHODS,
        *(_difference(method) for method in (1, 2, 3, 4)),
        Shown("1", _right_minus_left(5), "method 5, of which the seed decides"),
        assumption=_COMMON,
    ),
)
