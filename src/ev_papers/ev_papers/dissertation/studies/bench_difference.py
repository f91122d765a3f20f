"""Model against bench for each of the five methods (dissertation, figure 5.26), and what the difference comes from."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np

from ev_papers.dissertation.measures import urban_cases
from ev_papers.dissertation.measures.urban_cases import BENCH, DRIVERS, FIVE, METHODS, SCENARIO, Values
from ev_papers.dissertation.studies import bench_cases
from ev_papers.dissertation.studies.bench_cases import IDEAL, apart, ideal
from ev_sim.figures.drawing import sheet
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Curve, Panel
from ev_sim.measures.metric import Metric
from ev_sim.study.study import Case, Results

ABOUT = "Dissertation, figure 5.26 - torque of model and bench for five methods, and what their difference comes from"
COLUMNS = (
    *("driver", "method", "model against bench [%]", "published, at most", "distance [%]"),
    *("exchange", "rotor before the transducer", *IDEAL, "bus"),
)
LEFT = 2
SUMS = ("largest_",)
PUBLISHED = "5..10"  # %, figure 5.26
RUNS: dict[str, tuple[str, Values]] = {
    "model": (SCENARIO, ()),
    "ideal": (BENCH, ideal()),
    "bench": (BENCH, ()),
    **{group: (BENCH, ideal(but=group)) for group in IDEAL},
    "bus": (BENCH, (*ideal(), ("test_bench", "method", "circuits_on_can"))),
}
SHORTEST = 16.0  # s: the first traction window of the cycle begins at 15.7 s
_ZOOM = 15.0  # s of the figure


def add_options(parser: argparse.ArgumentParser) -> None:
    """Which drivers."""
    parser.add_argument(
        "--drivers", nargs="+", choices=DRIVERS, default=["imposed_speed", "pulse"], help="default: imposed_speed pulse"
    )


def _name(method: str, driver: str, run: str) -> str:
    return f"method {method} {driver} {run}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Of each method the model, the bench, an ideal bench, and one with each group of its faults, or the bus, alone."""
    return [
        urban_cases.case(method, driver, 1, _name(method, driver, run), values, scenario)
        for driver in given.drivers
        for method in FIVE
        for run, (scenario, values) in RUNS.items()
    ]


measure = bench_cases.measure


def _of(results: Results, method: str, driver: str, run: str) -> Any:
    return results[_name(method, driver, run)].measured


def differences(results: Results, method: str, driver: str) -> dict[str, float]:
    """Mean differences of the right torque in traction over its largest value [%], in the order of COLUMNS.

    Exchange: ideal bench against the model. Rotor: what the transducer shows of it against what drives the car. Groups:
    each alone on an otherwise ideal bench, against that.
    """
    of = {run: _of(results, method, driver, run) for run in RUNS}
    model, exact = of["model"], of["ideal"]
    counted = model["in_traction"]
    return {
        "bench": apart(of["bench"]["transducer"], model["torque"], counted),
        "distance": 100.0 * abs(of["bench"]["distance"] / model["distance"] - 1.0),
        "exchange": apart(exact["torque"], model["torque"], counted),
        "rotor": apart(exact["transducer"], exact["torque"], counted),
        **{cause: apart(of[cause]["transducer"], exact["transducer"], counted) for cause in (*IDEAL, "bus")},
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The difference of each method, and the largest."""
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        of = {method: differences(results, method, driver)["bench"] for method in FIVE}
        found.update({f"difference_{method}_{driver}": Metric(value, "%") for method, value in of.items()})
        found[f"largest_difference_{driver}"] = Metric(max(of.values()), "%")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """One for each driver and method."""
    found = []
    for driver in given.drivers:
        for method in FIVE:
            first, distance, *rest = (f"{value:.2f}" for value in differences(results, method, driver).values())
            found.append((driver, f"{method} {METHODS[method].title}", first, PUBLISHED, distance, *rest))
    return found


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """Figure 5.26 for each method: model and bench, over some seconds of the first window of traction."""
    shown = {}
    for driver in given.drivers:
        panels = []
        for method in FIVE:
            model, bench = (_of(results, method, driver, run) for run in ("model", "bench"))
            begin = float(model["instants"][np.argmax(model["in_traction"])])
            part = slice(*np.searchsorted(model["instants"], (begin, begin + _ZOOM)))
            time = model["instants"][part]
            curves = [
                Curve(time, model["torque"][part], "model"),
                Curve(time[: len(bench["transducer"][part])], bench["transducer"][part], "bench"),
            ]
            panels.append(Panel(f"Right torque, method {method}", "torque [N m]", curves))
        shown[f"figure_5_26_{driver}"] = sheet(
            panels, "time [s]", columns=1, start=float(panels[0].curves[0].time[0]), panel_width=7.0
        )
    return shown
