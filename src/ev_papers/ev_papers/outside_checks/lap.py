"""Torque vectoring against a fixed split on a lap: the best clean lap over the driver's speed.

S. Broere, J. van Kampen, M. Salazar (2021), Minimum-lap-time control strategies for all-wheel drive
electric race cars via convex optimization, arXiv 2111.04650.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ev_papers.outside_checks import cases as drawn_cases
from ev_papers.outside_checks.cases import (
    BASE,
    LAW,
    SENSORS,
    TRUTH,
    Setting,
    Values,
    interval,
    law,
    number_drawn,
)
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, NotMeasured, metric
from ev_stack.measures.named import driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results

ABOUT = (
    "Broere 2021: the best clean lap with torque vectoring against a fixed split, "
    "over the driver's speed"
)
DRAWS = 5
VECTORED = "pi_neutral_least_squares"
LESS = "accelerates less"
MORE_FRONT = "80 % of the brakes front"
FRONT_BRAKES = "70 % front, no recuperation"
# Differences from the file, of the driver or the brakes.
SETUPS: Mapping[str, Values] = {
    "": (),
    LESS: (("driver", "limit.driving", 0.6),),
    MORE_FRONT: ((LAW, "brake.front_share", 0.8),),
    FRONT_BRAKES: (
        (LAW, "brake.front_share", 0.7),
        ("driver", "speed_control.max_regenerative_torque", 0.0),
    ),
}
BALANCES = ("", MORE_FRONT, FRONT_BRAKES)  # setups that differ in the brakes alone
COLUMNS = (
    "driven wheels",
    "setup",
    "known",
    "law",
    "best clean lap [s]",
    "highest clean scale",
    "gain [%]",
)
HEADING = (
    "medians of the draws with their 95 % intervals; "
    "gain: less time than with equal torques, same car and setup"
)
LEFT = 4
SUMS = ()


class Cell(NamedTuple):
    """Car and setup, and what a law knows there."""

    car: str = "all"
    setup: str = ""
    known: str = TRUTH

    def name_of(self, of_law: str) -> str:
        """Name of the laps of a law; equal torques know nothing."""
        known = "" if of_law == BASE else self.known
        return " ".join(word for word in (self.car, self.setup, known, of_law) if word)


SCALES = tuple(n / 100 for n in range(78, 99))  # of the speed profile
CELLS: Mapping[Cell, tuple[str, ...]] = {  # with their laws
    Cell(): (BASE, "pi", "pi_neutral", VECTORED),
    Cell(known=SENSORS): (VECTORED,),
    Cell(setup=LESS): (BASE, VECTORED),
    Cell(setup=MORE_FRONT): (BASE, VECTORED),
    Cell(setup=FRONT_BRAKES): (BASE, VECTORED),
    Cell("front"): (BASE, VECTORED),
    Cell("rear"): (BASE, VECTORED),
}


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law at every scale in every draw; the driver knows the drawn friction."""
    found = []
    for cell, laws in CELLS.items():
        setting = Setting(cell.car, "lap", "dry")
        for of_law in laws:
            for draw in range(DRAWS):
                friction = ("driver", "limit.friction", number_drawn("friction", draw))
                changed = (*law(of_law, cell.known), *SETUPS[cell.setup], friction)
                for scale in SCALES:
                    name = f"{cell.name_of(of_law)} {scale:.2f}: {draw}"
                    values = (*changed, ("driver", "limit.scale", scale))
                    found.append(drawn_cases.case(name, setting, draw, values))
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Lap time [s], None without a clean lap to its end, and the largest sideslip angle [rad]."""
    try:
        time: float | None = METRICS["lap_time"].of(driven_run(recording, run.configurations))
    except NotMeasured:
        time = None
    return {"lap_time": time, "sideslip": peak_sideslip(recording)}


def _clean(results: Results, cell: Cell, of_law: str) -> np.ndarray:
    """Lap times by draw and scale, (draws, scales) [s]; infinite where the lap is not clean."""
    times = np.full((DRAWS, len(SCALES)), math.inf)
    for draw in range(DRAWS):
        for n, scale in enumerate(SCALES):
            measured = results[f"{cell.name_of(of_law)} {scale:.2f}: {draw}"].measured
            time = measured.get("lap_time")
            if time is not None:
                times[draw, n] = time
    return times


def best(results: Results, cell: Cell, of_law: str) -> np.ndarray:
    """Shortest clean lap of each draw, (draws,) [s]; infinite where there is none."""
    shortest: np.ndarray = _clean(results, cell, of_law).min(axis=1)
    return shortest


def highest(results: Results, cell: Cell, of_law: str) -> np.ndarray:
    """Highest scale of a clean lap of each draw, (draws,) [1]; 0 where there is none."""
    clean = np.isfinite(_clean(results, cell, of_law))
    return np.where(clean, SCALES, 0.0).max(axis=1)


def gains(results: Results, cell: Cell, of_law: str) -> np.ndarray:
    """Gain over the best lap with equal torques in each draw, (draws,) [1]."""
    # Without a clean lap the ratio is inf/inf, which is no gain and no loss.
    with np.errstate(invalid="ignore"):
        return 1.0 - best(results, cell, of_law) / best(results, cell, BASE)


def gains_by_best_brakes(results: Results, of_law: str) -> np.ndarray:
    """Gain with four driven wheels where both have the brakes with which they are fastest [1]."""

    def fastest(name: str) -> np.ndarray:
        return np.min([best(results, Cell(setup=each), name) for each in BALANCES], axis=0)

    shares: np.ndarray = 1.0 - fastest(of_law) / fastest(BASE)
    return shares


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Median gain by cell and law."""
    found = {}
    for cell, laws in CELLS.items():
        for of_law in laws:
            if of_law != BASE:
                by_draw = gains(results, cell, of_law)
                found[f"gain {cell.name_of(of_law)}"] = metric(
                    lambda by_draw=by_draw: float(np.median(by_draw)), "1"
                )
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Best lap, highest clean scale and gain by cell and law."""

    def shown(values: np.ndarray, form: str) -> str:
        lacking = int((~np.isfinite(values)).sum())
        if lacking:
            return f"none in {lacking} draws"
        middle, low, high = (format(each, form) for each in interval(values))
        return f"{middle} [{low}, {high}]"

    found = []
    for cell, laws in CELLS.items():
        for of_law in laws:
            is_base = of_law == BASE
            found.append(
                (
                    cell.car,
                    cell.setup or "as the file",
                    "–" if is_base else cell.known,
                    of_law,
                    shown(best(results, cell, of_law), ".2f"),
                    shown(highest(results, cell, of_law), ".2f"),
                    "" if is_base else shown(100.0 * gains(results, cell, of_law), ".1f"),
                )
            )
    return found
