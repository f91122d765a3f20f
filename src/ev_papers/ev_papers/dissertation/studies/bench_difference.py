"""Model against bench for each of the five methods (dissertation, figure 5.26), and what the difference comes from."""

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
from ev_stack.scenarios.scenario import Run
from ev_study.studies.study import Case, Results

WHEEL = "front_right"
SAMPLING = 0.005  # s between the samples that are compared, as far as the control period divides it
_STIFF, _NO_LIMIT = 1e7, 1e9
_SENSORS = (
    "bench_torque",
    "bench_speed",
    "bench_load_speed",
    "bench_voltage",
    "bench_current",
    "bench_temperature",
)


def _bench(**values: float) -> Values:
    return tuple(("test_bench", name.replace("__", "."), value) for name, value in values.items())


# By what may differ from the virtual run; with all of them ideal nothing is left but the exchange by control periods.
IDEAL: Mapping[str, Values] = {
    "inverters": _bench(
        set_point__delay=0.0,
        set_point__torque_rate=_NO_LIMIT,
        set_point__torque_resolution=0.0,
        load_set_point__delay=0.0,
        load_set_point__speed_rate=_NO_LIMIT,
        load_set_point__speed_resolution=0.0,
    ),
    "load machine": (("plant", "wheel_speed", "virtual"),),  # it turns exactly with its set-point
    "shaft": _bench(shaft__stiffness=_STIFF),
    "sensors": tuple(("test_bench", f"sensors.{name}.noise", 0.0) for name in _SENSORS),
}


def ideal(but: str = "") -> Values:
    """An ideal bench, but for one group that stays as the scenario has it."""
    return tuple(value for group, values in IDEAL.items() if group != but for value in values)


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Of the right circuit: torque at the shaft [N m], with the rotor and as a transducer shows it, and wheel speed.

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
    """Samples, True where for two samples before and behind both drivers' feet stay and are alike."""
    count = min(len(one), len(other))
    feet = np.stack([one[:count], other[:count]])
    moves = np.diff(feet, axis=1, prepend=feet[:, :1]).any(axis=0) | (feet[0] != feet[1])
    return np.convolve(moves, np.ones(5), "same") == 0.0


def apart(one: np.ndarray, other: np.ndarray, counted: np.ndarray | None = None) -> float:
    """Mean difference of two series over the largest magnitude of the second [%]."""
    count = min(len(one), len(other))
    difference = np.abs(one[:count] - other[:count])
    largest = float(np.abs(other).max())
    mean = float((difference if counted is None else difference[counted[:count]]).mean())
    return 100.0 * mean / largest if largest > 0.0 else 0.0


ABOUT = "Dissertation, figure 5.26 - torque of model and bench for five methods, and what their difference comes from"
COLUMNS = (
    *("driver", "method", "model against bench [%]", "published, at most", "distance [%]"),
    *("exchange", "rotor before the transducer", *IDEAL, "bus"),
)
LEFT = 2
SUMS = ("largest_",)
PUBLISHED = "5..10"  # %, figure 5.26
BENCHES: dict[str, tuple[str, Values]] = {
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
        "--drivers",
        nargs="+",
        choices=DRIVERS,
        default=["imposed_speed", "pulse"],
        help="default: imposed_speed pulse",
    )


def _name(method: str, driver: str, run: str) -> str:
    return f"method {method} {driver} {run}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Of each method the model, the bench, an ideal bench, and one with each group of its faults, or the bus, alone."""
    return [
        urban_cases.case(method, driver, 1, _name(method, driver, run), values, scenario)
        for driver in given.drivers
        for method in FIVE
        for run, (scenario, values) in BENCHES.items()
    ]


def _of(results: Results, method: str, driver: str, run: str) -> Any:
    return results[_name(method, driver, run)].measured


def differences(results: Results, method: str, driver: str) -> dict[str, float]:
    """Mean differences of the right torque in traction over its largest value [%], in the order of COLUMNS.

    Exchange: ideal bench against the model. Rotor: what the transducer shows of it against what drives the car. Groups:
    each alone on an otherwise ideal bench, against that.
    """
    of = {run: _of(results, method, driver, run) for run in BENCHES}
    model, exact = of["model"], of["ideal"]
    counted = model["in_traction"]
    return {
        "bench": apart(of["bench"]["transducer"], model["torque"], counted),
        "distance": 100.0 * abs(of["bench"]["distance"] / model["distance"] - 1.0),
        "exchange": apart(exact["torque"], model["torque"], counted),
        "rotor": apart(exact["transducer"], exact["torque"], counted),
        **{
            cause: apart(of[cause]["transducer"], exact["transducer"], counted)
            for cause in (*IDEAL, "bus")
        },
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The difference of each method, and the largest."""
    found: dict[str, Metric] = {}
    for driver in given.drivers:
        of = {method: differences(results, method, driver)["bench"] for method in FIVE}
        found.update(
            {f"difference_{method}_{driver}": Metric(value, "%") for method, value in of.items()}
        )
        found[f"largest_difference_{driver}"] = Metric(max(of.values()), "%")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """One for each driver and method."""
    found = []
    for driver in given.drivers:
        for method in FIVE:
            first, distance, *rest = (
                f"{value:.2f}" for value in differences(results, method, driver).values()
            )
            found.append(
                (driver, f"{method} {METHODS[method].title}", first, PUBLISHED, distance, *rest)
            )
    return found


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
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
        shown[f"figure_5_26_{driver}"] = Sheet(
            panels, columns=1, start=float(panels[0].curves[0].time[0])
        )
    return shown
