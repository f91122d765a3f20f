"""The friction that a law is told, 0.5 to 1.5 times the true one, by controller and with or without a sideslip loop.

L. De Novellis, A. Sorniotti, P. Gruber, A. Pennycott (2014), Comparison of feedback control techniques for
torque-vectoring control of fully electric vehicles, IEEE Trans. Vehicular Technology 63(8), 3612.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence

import numpy as np

from ev_papers.outside_checks import cases as drawn_cases
from ev_papers.outside_checks.cases import (
    BASE,
    DRAWS,
    LIMIT,
    SENSORS,
    TRUTH,
    interval,
    law,
    of_draws,
)
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = "De Novellis 2014: wrong friction given to PI and two second-order sliding modes, with and without a sideslip loop"
TOLD = (0.5, 0.75, 1.0, 1.25, 1.5)
LOOPS = {
    "": "understeer",
    " + sideslip": "sideslip_limit",
}  # what is added to the name, and the reference
LAWS = ("pi", "super_twisting", "suboptimal")
MANOEUVRE = "hard_step"
# Cars and roads, and what the laws know there: with the friction known the factor alone is wrong.
CELLS = (
    ("all", "wet", TRUTH),
    ("all", "wet", SENSORS),
    ("all", "snow", TRUTH),
    ("front", "wet", TRUTH),
    ("rear", "wet", TRUTH),
)
COLUMNS = ("driven wheels", "road", "known", "law", *(f"given {told:g}" for told in TOLD))
HEADING = "largest sideslip angle [deg], median with its 95 % interval, and draws below 10 deg"
LEFT = 4
SUMS = ()


def name_of(car: str, road: str, known: str, controller: str, told: float) -> str:
    """Name of the draws of a law, of one that knows nothing where it is that of equal torques."""
    return (
        f"{car} {road} {known} {controller} {told:g}"
        if controller != BASE
        else f"{car} {road} {BASE}"
    )


def _laws() -> Iterator[tuple[str, str, str]]:
    for controller in LAWS:
        for suffix, reference in LOOPS.items():
            yield f"{controller}{suffix}", controller, reference


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law with every friction that it is told, in every cell; equal torques beside them once."""
    found: dict[str, Case] = {}

    def add(name: str, car: str, road: str, of_law: drawn_cases.Values) -> None:
        for draw in range(DRAWS):
            one = f"{name}: {draw}"
            found.setdefault(one, drawn_cases.case(one, car, MANOEUVRE, road, draw, of_law))

    for car, road, known in CELLS:
        add(name_of(car, road, known, BASE, 1.0), car, road, law(BASE))
        for name, controller, reference in _laws():
            for told in TOLD:
                of_law = law(controller, known, told, reference=reference)
                add(name_of(car, road, known, name, told), car, road, of_law)
    return list(found.values())


measure = drawn_cases.measure


def sideslips(
    results: Results, car: str, road: str, known: str, name: str, told: float
) -> np.ndarray:
    """The largest sideslip angle of each draw, (draws,) [rad]."""
    return of_draws(results, name_of(car, road, known, name, told), "sideslip")


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The share of the draws that stay below the limit by law, where 1.5 times the friction is told."""
    return {
        f"held {car} {road} {known} {name}": metric(
            lambda cell=(car, road, known, name): float(
                (sideslips(results, *cell, TOLD[-1]) < LIMIT).mean()
            ),
            "1",
        )
        for car, road, known in CELLS
        for name, *_ in _laws()
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Largest sideslip angle and draws held by cell, law and told friction."""

    def shown(values: np.ndarray) -> str:
        middle, low, high = (f"{math.degrees(each):.1f}" for each in interval(values))
        return f"{middle} [{low}, {high}], {int((values < LIMIT).sum())}"

    found = []
    for car, road, known in CELLS:
        base = shown(sideslips(results, car, road, known, BASE, 1.0))
        found.append((car, road, "–", BASE, *("" if told != 1.0 else base for told in TOLD)))
        for name, *_ in _laws():
            by_told = (shown(sideslips(results, car, road, known, name, told)) for told in TOLD)
            found.append((car, road, known, name, *by_told))
    return found
