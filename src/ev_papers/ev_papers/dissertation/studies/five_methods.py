"""All five methods over all seeds and drivers, beside tables 3.1 to 3.6 and 5.1 to 5.6."""

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
    WITHOUT_F_SURFACE,
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

ABOUT = (
    "Dissertation, tables 3.1 to 3.6 and 5.1 to 5.6 "
    "- five methods, three drivers, many roads (--seeds N)"
)
COLUMNS = (
    "driver",
    "method",
    "2.37 right",
    "left",
    "mean",
    "printed",
    "speeds alone",
    "whole windows",
    "2.38 right",
    "left",
    "mean",
    "printed",
    "2.39",
    "printed",
    "energy, 2.40 [kW min]",
    "over the windows",
    "with n in traction",
    "printed, as kWh",
)
LEFT = 2
SUMS = ("methods_apart_", "method_1_above_2_", "seeds_with_", "gain_")
MEASURED = {  # quantities of `urban_cases.measure` by unit
    "1": (
        "wheel_efficiency_right",
        "wheel_efficiency_left",
        "wheel_efficiency",
        "wheel_efficiency_windows",
        "wheel_speed_efficiency_right",
        "wheel_speed_efficiency_left",
        "wheel_speed_efficiency",
        "wheel_power_efficiency",
        "drive_efficiency_right",
        "drive_efficiency_left",
        "drive_efficiency",
        "total_efficiency",
    ),
    "J": ("energy", "energy_windows", "energy_as_printed"),
}
KILOWATT_MINUTE = 60e3  # [J]; 99.66 kWh in 580 s would be 619 kW
KILOWATT_HOUR = 3.6e6  # [J]
_METHODS = range(1, 6)

measure = urban_cases.measure


def _table(id: str, unit: float = 1.0, name: str = "") -> dict[int, float]:
    """Values in published.csv of an id, in which {} stands for a method, by method."""
    return {
        method: published_value("dissertation", id.format(method), name) * unit
        for method in _METHODS
    }


# Table 3.6. Tables 3.1 to 3.5 have right and left, and tables 5.1 to 5.5 the same numbers again,
# but no mean.
WHEEL_EFFICIENCY = _table("diss.t3.6.m{}.mean")
# Table 5.6, printed in per cent, and the energy as kWh.
BENCH_WHEEL_EFFICIENCY = _table("diss.t5.6.wheel.m{}", 0.01)
DRIVE_EFFICIENCY = _table("diss.t5.6.drive.m{}", 0.01)
TOTAL_EFFICIENCY = _table("diss.t5.6.total.m{}", 0.01)
ENERGY = _table("diss.t5.6.energy.m{}", name="energy")


class Gains(NamedTuple):
    """Gains of method 1 over each other method, in per cent of method 1 and of the other one.

    Eqs 3.1 and 5.2 are printed with the first denominator. Eq 5.1 is printed with the second, yet
    the range printed for it comes from the first.
    """

    over_method_1: dict[int, float]
    over_the_other: dict[int, float]


def gains(efficiency: Mapping[int, float]) -> Gains:
    """Gains of efficiencies [1] by number of the method, above zero."""
    best = efficiency[1]
    others = {method: value for method, value in efficiency.items() if method != 1}
    return Gains(
        over_method_1={n: 100.0 * (best - value) / best for n, value in others.items()},
        over_the_other={n: 100.0 * (best - value) / value for n, value in others.items()},
    )


def savings(energy: Mapping[int, float]) -> dict[int, float]:
    """Savings by method 1, E_i - E_1, by number of the other method, in the unit of energy."""
    return {method: value - energy[1] for method, value in energy.items() if method != 1}


def efficiency_figure(
    points: Mapping[str, Mapping[int, Sequence[float]]],
    printed: Mapping[int, float],
    titles: Mapping[int, str],
) -> Sheet:
    """A panel for each driver, by method: seeds as dots, mean and printed value as lines."""

    def draw_seeds(axes: Axes, method: int, values: Sequence[float]) -> None:
        at = [method] * len(values)
        axes.plot(at, values, ".", color=HUES[0], markersize=3, label="a seed")
        axes.hlines(
            sum(values) / len(values),
            method - 0.3,
            method + 0.3,
            color=HUES[0],
            linewidth=1.6,
            label="mean of the seeds",
        )

    def draw_printed(axes: Axes, method: int) -> None:
        value = printed[method]
        axes.hlines(value, method - 0.4, method + 0.4, label="printed", **PUBLISHED)

    def ground(axes: Axes, by_method: Mapping[int, Sequence[float]]) -> None:
        for method, values in by_method.items():
            if values:
                draw_seeds(axes, method, values)
            if method in printed:
                draw_printed(axes, method)
        axes.set_xticks(list(by_method))
        axes.set_ylim(0.4, 1.0)
        axes.grid(False, axis="x")

    def methods(by_method: Mapping[int, Sequence[float]]) -> str:
        return "method: " + ", ".join(f"{method} {titles[method]}" for method in by_method)

    panels = []
    for driver, of in points.items():
        drawn = partial(ground, by_method=of)
        title = f"driver {readable(driver)}"
        panels.append(Panel(title, "wheel efficiency [1]", ground=drawn, xlabel=methods(of)))
    return Sheet(panels, columns=3)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the bench, the number of roads, and the drivers."""
    parser.add_argument(
        "--bench", action="store_true", help="with both motors on the test bench: tables 5.1 to 5.6"
    )
    parser.add_argument(
        "--without-f-surface",
        action="store_true",
        help="roads without f_surface of table 2.2, with f_0 and k fitted to table 3.6",
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
    scenario = BENCH if given.bench else SCENARIO
    further = WITHOUT_F_SURFACE if given.without_f_surface else ()
    found = []
    for driver in given.drivers:
        for method in METHODS:
            for seed in roads(given):
                found.append(
                    urban_cases.case(method, driver, seed, further=further, scenario=scenario)
                )
    return found


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Means over the seeds of each quantity by method and driver; then orders and gains.

    Of `imposed_speed` orders and gains are those of the ratio of speeds alone, so eq 2.37 without
    rolling resistance in M_f; of the other drivers those of eq 2.37 in full.
    """
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        for method in METHODS:
            values = values_of(given, results, method, driver)
            for unit, names in MEASURED.items():
                for name in names:
                    of_name = [value[name] for value in values]
                    found[f"{name}_{method}_{driver}"] = _mean(of_name, unit)
        found |= _orders(given, results, driver)
        found |= _gains(found, driver)
    return found


def values_of(
    given: argparse.Namespace, results: Results, method: str, driver: str
) -> list[Mapping[str, Any]]:
    """Numbers of a method with each seed in order, without cases that gave none."""
    names = (case_name(method, driver, seed) for seed in roads(given))
    driven = (results[name].measured for name in names if name in results)
    return [measured for measured in driven if measured]


def judged_quantity(driver: str) -> str:
    """Wheel efficiency that is held against tables 3.1 to 3.6.

    With imposed speed it is the ratio of speeds alone.
    """
    return "wheel_speed_efficiency" if driver == "imposed_speed" else "wheel_efficiency"


def _mean(values: Sequence[float], unit: str) -> Metric:
    if not values:
        return Metric(None, unit, reason="no case came to a traction window")
    return mean_over_seeds(values, unit)


def _orders(given: argparse.Namespace, results: Results, driver: str) -> dict[str, Metric]:
    """Spread over the methods, seeds with 1 > 3 >= 4 > 2 and 1 > 2, and distance of 1 above 2."""
    key = judged_quantity(driver)
    columns = []
    for method in FIVE:
        columns.append([value[key] for value in values_of(given, results, method, driver)])
    # Without all methods on the same roads there is no order.
    if len({len(column) for column in columns}) > 1 or not columns[0]:
        return {}
    apart, above, in_order = [], [], []
    for one, two, three, four, five in zip(*columns, strict=True):
        all_five = (one, two, three, four, five)
        apart.append(max(all_five) - min(all_five))
        above.append(one - two)
        in_order.append(one > three >= four > two)
    unit = f"of {len(apart)}"
    return {
        f"methods_apart_{driver}": _mean(apart, "1"),
        f"method_1_above_2_{driver}": _mean(above, "1"),
        f"seeds_with_1_above_2_{driver}": Metric(sum(each > 0.0 for each in above), unit),
        f"seeds_with_1_3_4_2_{driver}": Metric(sum(in_order), unit),
    }


def _gains(found: Mapping[str, Metric], driver: str) -> dict[str, Metric]:
    """Smallest and largest gain of method 1 over method 1 and over the other; eqs 3.1, 5.1, 5.2."""
    of = {"3_1": judged_quantity(driver), "5_1": "drive_efficiency", "5_2": "total_efficiency"}
    shown = {}
    for equation, quantity in of.items():
        by_method = {int(method): found[f"{quantity}_{method}_{driver}"].value for method in FIVE}
        if any(not value for value in by_method.values()):
            continue
        for denominator, by_other in gains(by_method)._asdict().items():
            name = f"gain_{equation}_{denominator}"
            values = by_other.values()
            shown[f"{name}_smallest_{driver}"] = Metric(min(values), "%")
            shown[f"{name}_largest_{driver}"] = Metric(max(values), "%")
    return shown


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Tables of the source, ours beside the printed ones, means with their standard deviation.

    Nothing is printed of another cycle.
    """
    found = metrics(given, results)

    def of_source(table: Mapping[int, float], number: int, form: str) -> str:
        return format(table[number], form) if given.cycle in (None, LISTED) else "-"

    def row(driver: str, method: str) -> tuple[str, ...]:
        def shown(name: str, factor: float = 1.0, form: str = ".3f") -> str:
            return _shown(found[f"{name}_{method}_{driver}"], factor, form)

        def three(name: str) -> tuple[str, ...]:
            """Right and left without their deviations, and the mean."""
            sides = (shown(f"{name}_{side}").partition(" ")[0] for side in SIDES)
            return (*sides, shown(name))

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
    """Wheel efficiency of the methods by driver, mean and single seeds, beside the printed one."""

    def of(method: str, driver: str) -> list[float]:
        key = judged_quantity(driver)
        return [value[key] for value in values_of(given, results, method, driver)]

    points = {}
    for driver in given.drivers:
        points[driver] = {int(method): of(method, driver) for method in FIVE}
    titles = {METHODS[method].number: METHODS[method].title for method in FIVE}
    of_source = WHEEL_EFFICIENCY if given.cycle in (None, LISTED) else {}
    return {"wheel_efficiency": efficiency_figure(points, of_source, titles)}
