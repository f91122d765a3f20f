"""Efficiencies and energies of the dissertation: tables 3.1 to 3.6 and 5.1 to 5.6."""

from __future__ import annotations

import statistics

from ev_papers.dissertation.assumptions import BENCH, IMPOSED, NO_ROLLING, OF_METHOD, ROAD, wheel_efficiency
from ev_papers.dissertation.runs import (
    FIVE_METHODS,
    FIVE_ON_BENCH,
    SPEEDS,
    ByMethod,
    mean,
    means,
    order,
    order_shown,
    seeds,
)
from ev_papers.dissertation.studies import printed as printed
from ev_sim.measures.metric import Band
from ev_sim.verdicts.check import Measure, Number, Shown, Tolerance, absolute, between, relative
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import StudyCases

_IMPOSED_SPEED = "imposed_speed"
_LOSSES = "loss model of the machine and its inverter (no map is left in the source)"
_ASSUMED = f"{BENCH}; {IMPOSED}; {_LOSSES}"
_UNKNOWN = absolute(0.02, "losses of the bench are unknown")
_POINTS = absolute(2.0, "losses of the bench are unknown")


def _side(method: int, side: str, value: float) -> Declaration:
    quantity = f"drive_efficiency_{side}"
    return judged(
        f"diss.t5.{method}.drive.{side}",
        FIVE_ON_BENCH,
        Number("1", value, _UNKNOWN, mean(quantity, method, _IMPOSED_SPEED)),
        Shown("1", mean(quantity, method, "pulse"), "with driver pulse"),
        assumption=_ASSUMED,
    )


def _total(method: int, wheel: str) -> Measure:
    """Mean over the roads of wheel times drive efficiency [%]."""

    def measure(driven: StudyCases) -> float:
        of = (seeds(driven, quantity, method, _IMPOSED_SPEED) for quantity in (wheel, "drive_efficiency"))
        return 100.0 * statistics.fmean(a * b for a, b in zip(*of, strict=True))

    return measure


def _drives_of(method: int) -> tuple[Declaration, ...]:
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
                mean("drive_efficiency", method, _IMPOSED_SPEED, 0.01),
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


_DRIVES_DECLARATIONS: tuple[Declaration, ...] = (
    *(declaration for method in printed.DRIVE_EFFICIENCY for declaration in _drives_of(method)),
    judged(
        "diss.t5.6.drive.order",
        FIVE_ON_BENCH,
        order("drive_efficiency", _IMPOSED_SPEED, _drive_order),
        assumption=_ASSUMED,
    ),
    judged(
        "diss.t5.6.total.order",
        FIVE_ON_BENCH,
        order("total_efficiency", _IMPOSED_SPEED, _total_order),
        assumption=_ASSUMED,
    ),
    judged(
        "diss.eq2.39.product",
        (),
        *(_beyond_the_product(method) for method in printed.TOTAL_EFFICIENCY),
        inputs="arithmetic of table 5.6 alone, not of our runs",
    ),
)


_PULSE = "pulse"
_OF_ENERGY = (
    f"{BENCH}; what is printed as kWh is kW min; it is the energy over the windows of traction, not eq 2.40 as "
    "printed, mean power of the 355.2 s of traction times the 580 s of the cycle; both circuits summed; driver "
    "pulse at k = 1.11 times the power of packed snow's limit, k fitted on method 2's wheel efficiency"
)


def _energy(method: int) -> Declaration:
    return judged(
        f"diss.t5.6.energy.m{method}",
        FIVE_ON_BENCH,
        Number(
            "kW min",
            printed.ENERGY[method],
            relative(0.05, "losses and lengths of the segments"),
            mean("energy_windows", method, _PULSE, printed.KILOWATT_MINUTE),
        ),
        Shown("kW min", mean("energy", method, _PULSE, printed.KILOWATT_MINUTE), "pedal pressed only"),
        Shown("kW min", mean("energy_as_printed", method, _PULSE, printed.KILOWATT_MINUTE), "eq 2.40 as printed"),
        Shown("kW h", mean("energy_as_printed", method, _PULSE, printed.KILOWATT_HOUR), "that is"),
        assumption=f"{_OF_ENERGY}; {OF_METHOD[method].replace('very number', 'method')}; {ROAD}",
    )


def _energies_in_order(of: ByMethod) -> bool:
    return of[1] < of[4] < of[3] < of[2] < of[5]


def _first_and_second(of: ByMethod) -> bool:
    return of[1] < of[2]


_ENERGY_DECLARATIONS: tuple[Declaration, ...] = (
    *map(_energy, printed.ENERGY),
    judged(
        "diss.t5.6.energy.order",
        FIVE_ON_BENCH,
        order("energy_windows", _PULSE, _energies_in_order),
        order_shown("energy_windows", _PULSE, _first_and_second, "1 < 2 alone"),
        assumption=f"{BENCH}; driver pulse",
    ),
)


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

_WHEELS_DECLARATIONS: tuple[Declaration, ...] = (
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


DECLARATIONS = (*_DRIVES_DECLARATIONS, *_ENERGY_DECLARATIONS, *_WHEELS_DECLARATIONS)
