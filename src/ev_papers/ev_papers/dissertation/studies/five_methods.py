"""All five methods over all seeds and drivers, beside tables 3.1 to 3.6 and 5.1 to 5.6 of the dissertation."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from ev_papers.dissertation.measures import urban_cases
from ev_papers.dissertation.measures.urban_cases import (
    BENCH,
    DRIVERS,
    FIVE,
    METHODS,
    SCENARIO,
    SIDES,
    case_name,
    roads,
)
from ev_sim.profiles.profile import LISTED
from ev_stack.figures.panels import Axes, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import HUES, PUBLISHED
from ev_stack.measures.metric import Metric, mean_over_seeds
from ev_study.studies.study import Case, Results
from ev_study.verdicts.sources import published_value

_METHODS = range(1, 6)


def _table(id: str, unit: float = 1.0) -> dict[int, float]:
    """By method what published.csv has of an id, in which it is written as {}, in multiples of a unit."""
    return {
        method: published_value("dissertation", id.format(method)) * unit for method in _METHODS
    }


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


def efficiency_figure(
    points: Mapping[str, Mapping[int, Sequence[float]]],
    printed: Mapping[int, float],
    titles: Mapping[int, str],
) -> Sheet:
    """One panel for each driver: the seeds as dots, their mean and the printed value, if any, as lines, by method."""

    def ground(axes: Axes, by_method: Mapping[int, Sequence[float]]) -> None:
        for method, values in by_method.items():
            if values:
                axes.plot(
                    [method] * len(values), values, ".", color=HUES[0], markersize=3, label="a seed"
                )
                mean = sum(values) / len(values)
                axes.hlines(
                    mean,
                    method - 0.3,
                    method + 0.3,
                    color=HUES[0],
                    linewidth=1.6,
                    label="mean of the seeds",
                )
            if method in printed:
                axes.hlines(
                    printed[method], method - 0.4, method + 0.4, label="printed", **PUBLISHED
                )
        axes.set_xticks(list(by_method))
        axes.set_ylim(0.4, 1.0)
        axes.grid(False, axis="x")

    def methods(by_method: Mapping[int, Sequence[float]]) -> str:
        return "method: " + ", ".join(f"{method} {titles[method]}" for method in by_method)

    panels = [
        Panel(
            f"driver {readable(driver)}",
            "wheel efficiency [1]",
            ground=partial(ground, by_method=of),
            xlabel=methods(of),
        )
        for driver, of in points.items()
    ]
    return Sheet(panels, columns=3)


ABOUT = "Dissertation, tables 3.1 to 3.6 and 5.1 to 5.6 - five methods, three drivers, many roads (--seeds N)"
COLUMNS = (
    *("driver", "method"),
    *("2.37 right", "left", "mean", "printed", "speeds alone", "whole windows"),
    *("2.38 right", "left", "mean", "printed"),
    *("2.39", "printed"),
    *("energy, 2.40 [kW min]", "over the windows", "with n in traction", "printed, as kWh"),
)
LEFT = 2
SUMS = ("methods_apart_", "method_1_above_2_", "seeds_with_", "gain_")
MEASURED = {  # quantities of `urban_cases.measure` by unit
    "1": (
        *(
            "wheel_efficiency_right",
            "wheel_efficiency_left",
            "wheel_efficiency",
            "wheel_efficiency_windows",
        ),
        *("wheel_speed_efficiency_right", "wheel_speed_efficiency_left", "wheel_speed_efficiency"),
        "wheel_power_efficiency",
        *(
            "drive_efficiency_right",
            "drive_efficiency_left",
            "drive_efficiency",
            "total_efficiency",
        ),
    ),
    "J": ("energy", "energy_windows", "energy_as_printed"),
}


def add_options(parser: argparse.ArgumentParser) -> None:
    """How many roads, and which drivers."""
    parser.add_argument(
        "--bench", action="store_true", help="with both motors on the test bench: tables 5.1 to 5.6"
    )
    parser.add_argument(
        "--seeds",
        type=int,
        default=10,
        metavar="N",
        help="roads, with the seeds 1 to N; default 10",
    )
    parser.add_argument(
        "--drivers",
        nargs="+",
        choices=DRIVERS,
        default=list(DRIVERS),
        help="default: all of them, one after the other",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every method with every driver on every road."""
    return [
        urban_cases.case(method, driver, seed, scenario=BENCH if given.bench else SCENARIO)
        for driver in given.drivers
        for method in METHODS
        for seed in roads(given)
    ]


measure = urban_cases.measure


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """All that was measured for each method and driver, means over the seeds; then orders and gains.

    Of `imposed_speed` orders and gains are those of the ratio of speeds alone, so eq 2.37 without rolling resistance in
    M_f; of the other drivers those of eq 2.37 in full.
    """
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        for method in METHODS:
            values = values_of(given, results, method, driver)
            for unit, names in MEASURED.items():
                for name in names:
                    found[f"{name}_{method}_{driver}"] = _mean(
                        [value[name] for value in values], unit
                    )
        found.update(_orders(given, results, driver))
        found.update(_gains(found, driver))
    return found


def values_of(
    given: argparse.Namespace, results: Results, method: str, driver: str
) -> list[Mapping[str, Any]]:
    """What was measured with the seeds in their order, without the cases that gave nothing or were not driven."""
    names = (case_name(method, driver, seed) for seed in roads(given))
    return [results[name].measured for name in names if name in results and results[name].measured]


def judged_quantity(driver: str) -> str:
    """The wheel efficiency that is held against tables 3.1 to 3.6: with imposed speed the ratio of speeds alone."""
    return "wheel_speed_efficiency" if driver == "imposed_speed" else "wheel_efficiency"


def _mean(values: Sequence[float], unit: str) -> Metric:
    if not values:
        return Metric(None, unit, reason="no case came to a traction window")
    return mean_over_seeds(values, unit)


def _orders(given: argparse.Namespace, results: Results, driver: str) -> dict[str, Metric]:
    """Spread over the methods, in how many seeds 1 > 3 >= 4 > 2 and 1 > 2 hold, and how far 1 lies above 2."""
    key = judged_quantity(driver)
    columns = [
        [value[key] for value in values_of(given, results, method, driver)] for method in FIVE
    ]
    if len({len(column) for column in columns}) > 1 or not columns[0]:
        return {}
    rows = list(zip(*columns, strict=True))
    count = len(rows)
    return {
        f"methods_apart_{driver}": _mean([max(row) - min(row) for row in rows], "1"),
        f"method_1_above_2_{driver}": _mean([row[0] - row[1] for row in rows], "1"),
        f"seeds_with_1_above_2_{driver}": Metric(
            sum(row[0] > row[1] for row in rows), f"of {count}"
        ),
        f"seeds_with_1_3_4_2_{driver}": Metric(
            sum(row[0] > row[2] >= row[3] > row[1] for row in rows), f"of {count}"
        ),
    }


def _gains(found: Mapping[str, Metric], driver: str) -> dict[str, Metric]:
    """Smallest and largest gain of method 1 by eqs 3.1, 5.1 and 5.2, over method 1 and over the other one."""
    of = {"3_1": judged_quantity(driver), "5_1": "drive_efficiency", "5_2": "total_efficiency"}
    shown = {}
    for equation, quantity in of.items():
        by_method = {int(method): found[f"{quantity}_{method}_{driver}"].value for method in FIVE}
        if any(not value for value in by_method.values()):
            continue
        for denominator, values in gains(by_method)._asdict().items():
            shown[f"gain_{equation}_{denominator}_smallest_{driver}"] = Metric(
                min(values.values()), "%"
            )
            shown[f"gain_{equation}_{denominator}_largest_{driver}"] = Metric(
                max(values.values()), "%"
            )
    return shown


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """The tables of the source, ours beside what is printed; of means the standard deviation over the seeds as well.

    Nothing is printed of another cycle.
    """
    found = metrics(given, results)

    def of_source(table: Mapping[int, float], number: int, form: str) -> str:
        return format(table[number], form) if given.cycle in (None, LISTED) else "-"

    def row(driver: str, method: str) -> tuple[str, ...]:
        def shown(name: str, factor: float = 1.0, form: str = ".3f") -> str:
            return _shown(found[f"{name}_{method}_{driver}"], factor, form)

        def three(name: str) -> tuple[str, ...]:
            return (*(shown(f"{name}_{side}").partition(" ")[0] for side in SIDES), shown(name))

        number = METHODS[method].number
        return (
            driver,
            f"{method} {METHODS[method].title}",
            *three("wheel_efficiency"),
            of_source(WHEEL_EFFICIENCY, number, ".2f"),
            shown("wheel_speed_efficiency"),
            shown("wheel_efficiency_windows"),
            *three("drive_efficiency"),
            of_source(DRIVE_EFFICIENCY, number, ".3f"),
            shown("total_efficiency"),
            of_source(TOTAL_EFFICIENCY, number, ".3f"),
            shown("energy", 1 / KILOWATT_MINUTE, ".1f"),
            shown("energy_windows", 1 / KILOWATT_MINUTE, ".1f"),
            shown("energy_as_printed", 1 / KILOWATT_MINUTE, ".1f"),
            of_source(ENERGY, number, ".1f"),
        )

    return [row(driver, method) for driver in given.drivers for method in METHODS]


def _shown(metric: Metric, factor: float = 1.0, form: str = ".3f") -> str:
    if metric.value is None:
        return "-"
    spread = metric.standard_deviation
    mean = format(factor * metric.value, form)
    return mean if spread is None else f"{mean} ± {format(factor * spread, form)}"


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Wheel efficiency of the methods, mean and single seeds, beside the printed one, for each driver."""
    points = {
        driver: {
            int(method): [
                value[judged_quantity(driver)]
                for value in values_of(given, results, method, driver)
            ]
            for method in FIVE
        }
        for driver in given.drivers
    }
    titles = {METHODS[method].number: METHODS[method].title for method in FIVE}
    of_source = WHEEL_EFFICIENCY if given.cycle in (None, LISTED) else {}
    return {"wheel_efficiency": efficiency_figure(points, of_source, titles)}
