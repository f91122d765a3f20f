"""Torque vectoring against a fixed split on a lap: the best clean lap of each, over scales of the driver's speed.

S. Broere, J. van Kampen, M. Salazar (2021), Minimum-lap-time control strategies for all-wheel drive electric race cars
via convex optimization, arXiv 2111.04650.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_papers.outside_checks import cases as drawn_cases
from ev_papers.outside_checks.cases import BASE, LAW, SENSORS, TRUTH, Values, drawn, interval, law
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, NotMeasured, metric
from ev_stack.measures.named import driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Run
from ev_study.studies.study import Case, Results

ABOUT = "Broere 2021: the best clean lap with torque vectoring against a fixed split, over the driver's speed"
DRAWS = 5
SCALES = tuple(n / 100 for n in range(78, 99))  # of the speed profile
VECTORED = "pi_neutral_least_squares"
FRONT_BRAKES = "70 % front, no recuperation"
SETUPS: Mapping[str, Values] = {  # what differs from the file, of the driver or the brakes
    "": (),
    "accelerates less": (("driver", "limit.driving", 0.6),),
    "80 % of the brakes front": ((LAW, "brake.front_share", 0.8),),
    FRONT_BRAKES: (
        (LAW, "brake.front_share", 0.7),
        ("driver", "speed_control.max_regenerative_torque", 0.0),
    ),
}
BALANCES = ("", "80 % of the brakes front", FRONT_BRAKES)
# Car, setup, what is known, laws.
CELLS: tuple[tuple[str, str, str, tuple[str, ...]], ...] = (
    ("all", "", TRUTH, (BASE, "pi", "pi_neutral", VECTORED)),
    ("all", "", SENSORS, (VECTORED,)),
    ("all", "accelerates less", TRUTH, (BASE, VECTORED)),
    ("all", "80 % of the brakes front", TRUTH, (BASE, VECTORED)),
    ("all", FRONT_BRAKES, TRUTH, (BASE, VECTORED)),
    ("front", "", TRUTH, (BASE, VECTORED)),
    ("rear", "", TRUTH, (BASE, VECTORED)),
)
COLUMNS = (
    "driven wheels",
    "setup",
    "known",
    "law",
    "best clean lap [s]",
    "highest clean scale",
    "gain [%]",
)
HEADING = "medians of the draws with their 95 % intervals; gain: less time than with equal torques, same car and setup"
LEFT = 4
SUMS = ()


def _name(car: str, setup: str, known: str, of_law: str) -> str:
    return " ".join(word for word in (car, setup, "" if of_law == BASE else known, of_law) if word)


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law at every scale in every draw; the driver knows the drawn friction."""
    found = []
    for car, setup, known, laws in CELLS:
        for of_law in laws:
            for draw in range(DRAWS):
                friction = ("driver", "limit.friction", float(drawn()["friction"][draw]))
                for scale in SCALES:
                    values: Values = (
                        *law(of_law, known),
                        *SETUPS[setup],
                        friction,
                        ("driver", "limit.scale", scale),
                    )
                    name = f"{_name(car, setup, known, of_law)} {scale:.2f}: {draw}"
                    found.append(drawn_cases.case(name, car, "lap", "dry", draw, values))
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Lap time [s], None if the car leaves the course or comes to no end, and the largest sideslip angle [rad]."""
    try:
        time: float | None = METRICS["lap_time"].of(driven_run(recording, run.configurations))
    except NotMeasured:
        time = None
    return {"lap_time": time, "sideslip": peak_sideslip(recording)}


def _clean(results: Results, car: str, of_law: str, setup: str, known: str) -> np.ndarray:
    """Lap times by draw and scale, (draws, scales) [s]; infinite where the lap is not clean."""
    name = _name(car, setup, known, of_law)
    times = [
        [results[f"{name} {scale:.2f}: {draw}"].measured.get("lap_time") for scale in SCALES]
        for draw in range(DRAWS)
    ]
    return np.array([[np.inf if time is None else time for time in row] for row in times])


def best(
    results: Results, car: str, of_law: str, setup: str = "", known: str = TRUTH
) -> np.ndarray:
    """The shortest clean lap of each draw, (draws,) [s]; infinite where there is none."""
    shortest: np.ndarray = _clean(results, car, of_law, setup, known).min(axis=1)
    return shortest


def highest(
    results: Results, car: str, of_law: str, setup: str = "", known: str = TRUTH
) -> np.ndarray:
    """The highest scale of a clean lap of each draw, (draws,) [1]; 0 where there is none."""
    clean = np.isfinite(_clean(results, car, of_law, setup, known))
    return np.where(clean, SCALES, 0.0).max(axis=1)


def gains(
    results: Results, car: str, of_law: str, setup: str = "", known: str = TRUTH
) -> np.ndarray:
    """By what a law shortens the best lap of equal torques in each draw, (draws,) [1]."""
    with np.errstate(invalid="ignore"):
        return 1.0 - best(results, car, of_law, setup, known) / best(results, car, BASE, setup)


def gains_by_best_brakes(results: Results, of_law: str) -> np.ndarray:
    """The same with four driven wheels, where each of both has that balance of the brakes with which it is fastest."""
    with_law, without = (
        np.min([best(results, "all", name, balance) for balance in BALANCES], axis=0)
        for name in (of_law, BASE)
    )
    shares: np.ndarray = 1.0 - with_law / without
    return shares


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The median gain by cell and law."""
    return {
        f"gain {_name(car, setup, known, of_law)}": metric(
            lambda cell=(car, of_law, setup, known): float(np.median(gains(results, *cell))), "1"
        )
        for car, setup, known, laws in CELLS
        for of_law in laws
        if of_law != BASE
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Best lap, highest clean scale and gain by cell and law."""

    def shown(values: np.ndarray, form: str) -> str:
        if not np.isfinite(values).all():
            return f"none in {int((~np.isfinite(values)).sum())} draws"
        middle, low, high = (format(each, form) for each in interval(values))
        return f"{middle} [{low}, {high}]"

    found = []
    for car, setup, known, laws in CELLS:
        for of_law in laws:
            cell = (car, of_law, setup, known)
            gain = "" if of_law == BASE else shown(100.0 * gains(results, *cell), ".1f")
            found.append(
                (
                    *(car, setup or "as the file", "–" if of_law == BASE else known, of_law),
                    *(
                        shown(best(results, *cell), ".2f"),
                        shown(highest(results, *cell), ".2f"),
                        gain,
                    ),
                )
            )
    return found
