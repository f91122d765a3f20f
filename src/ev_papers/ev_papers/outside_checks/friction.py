"""Wrong friction in a law, 0.5 to 1.5 times the true one, with and without a sideslip loop.

L. De Novellis, A. Sorniotti, P. Gruber, A. Pennycott (2014), Comparison of feedback control
techniques for torque-vectoring control of fully electric vehicles, IEEE Trans. Vehicular
Technology 63(8), 3612.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ev_papers.outside_checks import cases as drawn_cases
from ev_papers.outside_checks.cases import (
    BASE,
    DRAWS,
    LIMIT,
    SENSORS,
    TRUTH,
    Setting,
    interval,
    law,
    of_draws,
)
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = (
    "De Novellis 2014: PI and two second-order sliding modes that believe in a wrong friction, "
    "with and without a sideslip loop"
)
FACTORS = (0.5, 0.75, 1.0, 1.25, 1.5)  # believed friction over the true one
LOOP = " + sideslip"  # ends the name of a law with a reference that limits the sideslip
MANOEUVRE = "hard_step"
HEADING = "largest sideslip angle [deg], median with its 95 % interval, and draws below 10 deg"
LEFT = 4
SUMS = ()


class Cell(NamedTuple):
    """Car and road, and what the laws know there: with the truth the factor alone is wrong."""

    car: str
    road: str
    known: str


class Law(NamedTuple):
    """A law by its name, of a controller and a reference."""

    name: str
    controller: str
    reference: str


LAWS = (
    Law("pi", "pi", "understeer"),
    Law(f"pi{LOOP}", "pi", "sideslip_limit"),
    Law("super_twisting", "super_twisting", "understeer"),
    Law(f"super_twisting{LOOP}", "super_twisting", "sideslip_limit"),
    Law("suboptimal", "suboptimal", "understeer"),
    Law(f"suboptimal{LOOP}", "suboptimal", "sideslip_limit"),
)
CELLS = (
    Cell("all", "wet", TRUTH),
    Cell("all", "wet", SENSORS),
    Cell("all", "snow", TRUTH),
    Cell("front", "wet", TRUTH),
    Cell("rear", "wet", TRUTH),
)
COLUMNS = (
    "driven wheels",
    "road",
    "known",
    "law",
    *(f"given {factor:g}" for factor in FACTORS),
)

measure = drawn_cases.measure


def name_of(cell: Cell, name: str, factor: float) -> str:
    """Name of the draws of a law; equal torques know nothing."""
    if name == BASE:
        return f"{cell.car} {cell.road} {BASE}"
    return f"{cell.car} {cell.road} {cell.known} {name} {factor:g}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law with every believed friction in every cell, and equal torques once."""
    found: dict[str, Case] = {}

    def add(cell: Cell, name: str, factor: float, of_law: drawn_cases.Values) -> None:
        setting = Setting(cell.car, MANOEUVRE, cell.road)
        for draw in range(DRAWS):
            one = f"{name_of(cell, name, factor)}: {draw}"
            found.setdefault(one, drawn_cases.case(one, setting, draw, of_law))

    for cell in CELLS:
        add(cell, BASE, 1.0, law(BASE))
        for each in LAWS:
            for factor in FACTORS:
                of_law = law(each.controller, cell.known, factor, reference=each.reference)
                add(cell, each.name, factor, of_law)
    return list(found.values())


def sideslips(results: Results, cell: Cell, name: str, factor: float) -> np.ndarray:
    """Largest sideslip angle of each draw, (draws,) [rad]."""
    return of_draws(results, name_of(cell, name, factor), "sideslip")


def held(sideslip: np.ndarray) -> float:
    """Share of the draws below the limit [1]."""
    return float((sideslip < LIMIT).mean())


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Share of the draws below the limit by law, at 1.5 times the friction."""
    found = {}
    for cell in CELLS:
        for each in LAWS:
            sideslip = sideslips(results, cell, each.name, FACTORS[-1])
            name = f"held {cell.car} {cell.road} {cell.known} {each.name}"
            found[name] = metric(lambda sideslip=sideslip: held(sideslip), "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Largest sideslip angle and draws held by cell, law and believed friction."""

    def shown(values: np.ndarray) -> str:
        middle, low, high = (f"{math.degrees(each):.1f}" for each in interval(values))
        return f"{middle} [{low}, {high}], {int((values < LIMIT).sum())}"

    found = []
    for cell in CELLS:
        base = shown(sideslips(results, cell, BASE, 1.0))
        by_factor = [base if factor == 1.0 else "" for factor in FACTORS]
        found.append((cell.car, cell.road, "–", BASE, *by_factor))
        for each in LAWS:
            by_factor = [shown(sideslips(results, cell, each.name, factor)) for factor in FACTORS]
            found.append((*cell, each.name, *by_factor))
    return found
