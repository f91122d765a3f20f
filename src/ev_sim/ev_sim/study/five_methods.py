"""All five methods over all seeds and drivers, beside tables 3.6 and 5.6 of the dissertation."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ev_sim.report.metric import Metric, Reference, mean_over_seeds
from ev_sim.report.text_table import text_table
from ev_sim.study import dissertation_tables as printed
from ev_sim.study import urban_cases
from ev_sim.study.case import Case
from ev_sim.study.study import Results
from ev_sim.study.urban_cases import DRIVERS, METHODS, TITLES, case_name, roads

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ABOUT = "Dissertation, tables 3.6 and 5.6 - five torque control methods, three drivers, many roads (--seeds N)"
COLUMNS = (
    "driver",
    "method",
    *("wheel efficiency", "printed"),
    *("drive efficiency", "printed"),
    *("total efficiency", "printed"),
    *("energy [kW min]", "printed, as kWh"),
)
SUMS = ("methods_apart_", "method_1_above_2_", "seeds_with_")


def add_options(parser: argparse.ArgumentParser) -> None:
    """How many roads, and which drivers."""
    parser.add_argument("--seeds", type=int, default=10, metavar="N", help="roads, with the seeds 1 to N; default 10")
    parser.add_argument(
        "--drivers", nargs="+", choices=DRIVERS, default=list(DRIVERS), help="default: all of them, one after the other"
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every method with every driver on every road."""
    return [
        urban_cases.case(method, driver, seed)
        for driver in given.drivers
        for method in METHODS
        for seed in roads(given)
    ]


measure = urban_cases.measure


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Table 3.6 and 5.6 for each driver, means over the seeds; then how often the methods come in their order.

    The wheel efficiency of `imposed_speed` is without rolling resistance in M_f, that of the others with it.
    """
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        for method in METHODS:
            values = _values(given, results, method, driver)
            end = f"{method}_{driver}"
            wheel = _wheel(values, driver)
            drive = [value["drive_efficiency"] for value in values]
            total = [a * b for a, b in zip(wheel, drive, strict=True)]
            energy = [value["energy"] for value in values]
            found[f"wheel_efficiency_{end}"] = _mean(wheel, "1", printed.wheel_efficiency(method, driver))
            found[f"drive_efficiency_{end}"] = _mean(drive, "1", printed.drive_efficiency(method))
            found[f"total_efficiency_{end}"] = _mean(total, "1", printed.total_efficiency(method))
            found[f"energy_{end}"] = _mean(energy, "J", printed.energy(method))
        found.update(_orders(given, results, driver))
    return found


def _values(given: argparse.Namespace, results: Results, method: int, driver: str) -> list[Mapping[str, Any]]:
    """What was measured with the seeds in their order, without the cases that gave nothing."""
    names = (case_name(method, driver, seed) for seed in roads(given))
    return [results[name].measured for name in names if results[name].measured]


def _wheel(values: Sequence[Mapping[str, Any]], driver: str) -> list[float]:
    key = "wheel_speed_efficiency" if driver == "imposed_speed" else "wheel_efficiency"
    return [value[key] for value in values]


def _mean(values: Sequence[float], unit: str, reference: Reference | None = None) -> Metric:
    if not values:
        return Metric(None, unit, reference, "no case came to a traction window")
    return mean_over_seeds(values, unit, reference)


def _orders(given: argparse.Namespace, results: Results, driver: str) -> dict[str, Metric]:
    """Spread over the methods, in how many seeds 1 > 3 >= 4 > 2 and 1 > 2 hold, and how far 1 lies above 2."""
    columns = [_wheel(_values(given, results, method, driver), driver) for method in METHODS]
    if len({len(column) for column in columns}) > 1 or not columns[0]:
        return {}
    rows = list(zip(*columns, strict=True))
    count = len(rows)
    return {
        f"methods_apart_{driver}": _mean([max(row) - min(row) for row in rows], "1"),
        f"method_1_above_2_{driver}": _mean([row[0] - row[1] for row in rows], "1"),
        f"seeds_with_1_above_2_{driver}": Metric(sum(row[0] > row[1] for row in rows), f"of {count}"),
        f"seeds_with_1_3_4_2_{driver}": Metric(sum(row[0] > row[2] >= row[3] > row[1] for row in rows), f"of {count}"),
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Tables 3.6 and 5.6, ours (mean and standard deviation over the seeds) beside what is printed."""
    found = metrics(given, results)
    efficiencies = (
        ("wheel_efficiency", printed.WHEEL_EFFICIENCY),
        ("drive_efficiency", printed.DRIVE_EFFICIENCY),
        ("total_efficiency", printed.TOTAL_EFFICIENCY),
    )
    return [
        (
            driver,
            f"{method} {TITLES[method]}",
            *(
                cell
                for quantity, of in efficiencies
                for cell in (_shown(found[f"{quantity}_{method}_{driver}"]), f"{of[method]:.3f}")
            ),
            _shown(found[f"energy_{method}_{driver}"], 1 / printed.KILOWATT_MINUTE, ".1f"),
            f"{printed.ENERGY[method]:.1f}",
        )
        for driver in given.drivers
        for method in METHODS
    ]


def tables(given: argparse.Namespace, results: Results) -> str:
    """The rows as aligned text."""
    return text_table(COLUMNS, rows(given, results), left=COLUMNS[:2])


def _shown(metric: Metric, factor: float = 1.0, form: str = ".3f") -> str:
    if metric.value is None:
        return "-"
    spread = metric.standard_deviation
    mean = format(factor * metric.value, form)
    return mean if spread is None else f"{mean} ± {format(factor * spread, form)}"


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """Wheel efficiency of the methods, mean and single seeds, beside the printed one, for each driver."""
    from ev_sim.study.efficiency_figure import efficiency_figure

    points = {
        driver: {method: _wheel(_values(given, results, method, driver), driver) for method in METHODS}
        for driver in given.drivers
    }
    return {"wheel_efficiency": efficiency_figure(points, printed.WHEEL_EFFICIENCY, TITLES)}
