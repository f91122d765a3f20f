"""Model against bench for each of the five methods (figure 5.26), and causes of the difference."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_papers.dissertation.measures import urban_cases
from ev_papers.dissertation.measures.traction_windows import in_windows
from ev_papers.dissertation.measures.urban_cases import (
    BENCH,
    DRIVERS,
    FIVE,
    METHODS,
    SCENARIO,
    Values,
)
from ev_stack.figures.panels import Curve, Panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import Metric, NotMeasured
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results

ABOUT = (
    "Dissertation, figure 5.26 - torque of model and bench for five methods, "
    "and what their difference comes from"
)
WHEEL = "front_right"
SAMPLING = 0.005  # [s] between compared samples, as far as the control period divides it
SHORTEST = 16.0  # [s]: the first traction window of the cycle begins at 15.7 s
PUBLISHED = "5..10"  # figure 5.26 [%]
LEFT = 2
SUMS = ("largest_",)
_ZOOM = 15.0  # [s] of the figure
_STIFF = 1e7  # [N m/rad]
_NO_LIMIT = 1e9
_SENSORS = (
    "bench_torque",
    "bench_speed",
    "bench_load_speed",
    "bench_voltage",
    "bench_current",
    "bench_temperature",
)
# Groups of what differs from the virtual run; with all of them ideal nothing is left but the
# exchange by control periods.
IDEAL: Mapping[str, Values] = {
    "inverters": (
        ("test_bench", "set_point.delay", 0.0),
        ("test_bench", "set_point.torque_rate", _NO_LIMIT),
        ("test_bench", "set_point.torque_resolution", 0.0),
        ("test_bench", "load_set_point.delay", 0.0),
        ("test_bench", "load_set_point.speed_rate", _NO_LIMIT),
        ("test_bench", "load_set_point.speed_resolution", 0.0),
    ),
    # It turns exactly with its set-point.
    "load machine": (("plant", "wheel_speed", "virtual"),),
    "shaft": (("test_bench", "shaft.stiffness", _STIFF),),
    "sensors": tuple(("test_bench", f"sensors.{name}.noise", 0.0) for name in _SENSORS),
}
BUS = "bus"
CAUSES = (*IDEAL, BUS)
COLUMNS = (
    "driver",
    "method",
    "model against bench [%]",
    "published, at most",
    "distance [%]",
    "exchange",
    "rotor before the transducer",
    *CAUSES,
)


def ideal(but: str = "") -> Values:
    """An ideal bench, but for one group that stays as the scenario has it."""
    values: Values = ()
    for group, of_group in IDEAL.items():
        if group != but:
            values += of_group
    return values


# By name of the run its scenario, and what differs from it.
BENCHES: Mapping[str, tuple[str, Values]] = {
    "model": (SCENARIO, ()),
    "ideal": (BENCH, ideal()),
    "bench": (BENCH, ()),
    **{group: (BENCH, ideal(but=group)) for group in IDEAL},
    BUS: (BENCH, (*ideal(), ("test_bench", "method", "circuits_on_can"))),
}


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Torque at the right shaft [N m], with the rotor and by a transducer, and wheel speed [rad/s].

    All of it at the `instants` [s]. NotMeasured if the run ends before the first traction window.
    """
    every = max(round(SAMPLING / run.configurations["plant"].common.control_period), 1)
    channels = recording.channels
    torque = channels[f"motor_states.effort.{WHEEL}"]
    shown = channels.get(f"bench.shafts.torque.{WHEEL}", torque)
    in_traction = in_windows(recording, run.configurations["driver"].values())
    if not in_traction.any():
        raise NotMeasured("the run has no traction window")
    return {
        "instants": recording.time[::every].copy(),
        "torque": torque[::every].copy(),
        "transducer": shown[::every].copy(),
        "speed": channels[f"wheel_states.velocity.{WHEEL}"][::every].copy(),
        "pressed": channels["driver.command.drive_torque"][::every] > 0.0,
        "in_traction": in_traction[::every].copy(),
        "distance": float(channels["pose.x"][-1]),
    }


def away_from_switches(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """True where for two samples before and behind both drivers' feet rest and are alike, (n,)."""
    count = min(len(one), len(other))
    feet = np.stack([one[:count], other[:count]])
    moves = np.diff(feet, axis=1, prepend=feet[:, :1]).any(axis=0)
    moves_or_differs = moves | (feet[0] != feet[1])
    return np.convolve(moves_or_differs, np.ones(5), "same") == 0.0


def apart(one: np.ndarray, other: np.ndarray, counted: np.ndarray | None = None) -> float:
    """Mean difference of two series over the largest magnitude of the second [%]."""
    count = min(len(one), len(other))
    difference = np.abs(one[:count] - other[:count])
    if counted is not None:
        difference = difference[counted[:count]]
    largest = float(np.abs(other).max())
    return 100.0 * float(difference.mean()) / largest if largest > 0.0 else 0.0


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the drivers."""
    parser.add_argument(
        "--drivers",
        nargs="+",
        choices=DRIVERS,
        default=["imposed_speed", "pulse"],
        help="default: imposed_speed pulse",
    )


def _name(method: str, driver: str, run: str) -> str:
    return f"method {method} {driver} {run}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Model, bench, an ideal bench, and one with each cause alone, for each method and driver."""
    found = []
    for driver in given.drivers:
        for method in FIVE:
            for run, (scenario, values) in BENCHES.items():
                name = _name(method, driver, run)
                found.append(urban_cases.case(method, driver, 1, name, values, scenario))
    return found


def _of(results: Results, method: str, driver: str, run: str) -> Mapping[str, Any]:
    return results[_name(method, driver, run)].measured


def differences(results: Results, method: str, driver: str) -> dict[str, float]:
    """Mean differences of the right torque in traction over its largest value [%].

    They are in the order of COLUMNS. Exchange: ideal bench against the model. Rotor: the torque at
    the transducer against the one that drives the car. Causes: each alone on an otherwise ideal
    bench, against that.
    """
    of = {run: _of(results, method, driver, run) for run in BENCHES}
    model, exact = of["model"], of["ideal"]
    counted = model["in_traction"]

    def by(cause: str) -> float:
        return apart(of[cause]["transducer"], exact["transducer"], counted)

    return {
        "bench": apart(of["bench"]["transducer"], model["torque"], counted),
        "distance": 100.0 * abs(of["bench"]["distance"] / model["distance"] - 1.0),
        "exchange": apart(exact["torque"], model["torque"], counted),
        "rotor": apart(exact["transducer"], exact["torque"], counted),
        **{cause: by(cause) for cause in CAUSES},
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Difference of each method, and the largest."""
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        largest = 0.0
        for method in FIVE:
            difference = differences(results, method, driver)["bench"]
            found[f"difference_{method}_{driver}"] = Metric(difference, "%")
            largest = max(largest, difference)
        found[f"largest_difference_{driver}"] = Metric(largest, "%")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """One for each driver and method."""
    found = []
    for driver in given.drivers:
        for method in FIVE:
            values = differences(results, method, driver).values()
            first, distance, *rest = (f"{value:.2f}" for value in values)
            title = f"{method} {METHODS[method].title}"
            found.append((driver, title, first, PUBLISHED, distance, *rest))
    return found


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """Figure 5.26 for each method: some seconds of the first window of traction."""
    shown = {}
    for driver in given.drivers:
        panels = [_panel(results, method, driver) for method in FIVE]
        start = float(panels[0].curves[0].time[0])
        shown[f"figure_5_26_{driver}"] = Sheet(panels, columns=1, start=start)
    return shown


def _panel(results: Results, method: str, driver: str) -> Panel:
    """Right torque of model and bench."""
    model = _of(results, method, driver, "model")
    bench = _of(results, method, driver, "bench")
    begin = float(model["instants"][np.argmax(model["in_traction"])])
    part = slice(*np.searchsorted(model["instants"], (begin, begin + _ZOOM)))
    time = model["instants"][part]
    measured = bench["transducer"][part]
    curves = [
        Curve(time, model["torque"][part], "model"),
        # The bench may have been stopped before.
        Curve(time[: len(measured)], measured, "bench"),
    ]
    return Panel(f"Right torque, method {method}", "torque [N m]", curves)
