"""Controllers, references and allocations on known friction, and with wrong tyres in the law.

M. Asperti, M. Vignati, E. Sabbioni (2024), On torque vectoring control: review and comparison of
state-of-the-art approaches, Machines 12(3), 160; De Novellis et al. (2014) as in `friction`;
"System-level performance of torque vectoring controllers", SAE 10-10-04-0029.
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
    CONTROLLERS,
    DRAWS,
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
    "Asperti 2024 and others: torque vectoring part by part on known friction, "
    "and with wrong tyres in the law"
)
WRONG = "wrong tyres"  # ends what is known where a law believes in drawn stiffnesses
ROAD_OF = {"ramp": "dry", "step": "dry", "sine": "wet", "lane_change": "snow"}
EVERY = (*CONTROLLERS, "pi_neutral", "pi_load", "pi_least_squares")
COLUMNS = (
    "driven wheels",
    "manoeuvre",
    "known",
    "law",
    "tracking error [mrad/s]",
    "sideslip [deg]",
    "energy [kJ]",
    "angle [deg]",
)
HEADING = (
    "medians of the draws with their 95 % intervals; "
    "angle: of the steering wheel on the ramp at 4 m/s^2"
)
LEFT = 4
SUMS = ()
# Quantities of the table, and the factor into the unit of their column.
_SHOWN = (
    ("tracking", 1e3),
    ("sideslip", math.degrees(1.0)),
    ("energy", 1e-3),
    ("angle", math.degrees(1.0)),
)


class Cell(NamedTuple):
    """Car and manoeuvre, what is known there, and the laws that drive it."""

    car: str
    manoeuvre: str
    known: str
    laws: tuple[str, ...] = CONTROLLERS


CELLS = (
    Cell("all", "ramp", TRUTH, EVERY),
    Cell("all", "ramp", SENSORS, EVERY),
    Cell("all", "step", TRUTH, EVERY),
    Cell("all", "step", SENSORS, EVERY),
    Cell("all", "sine", TRUTH, EVERY),
    Cell("all", "sine", SENSORS, EVERY),
    Cell("all", "lane_change", TRUTH, EVERY),
    Cell("all", "lane_change", SENSORS, EVERY),
    Cell("front", "step", TRUTH),
    Cell("front", "sine", TRUTH),
    Cell("rear", "step", TRUTH),
    Cell("rear", "sine", TRUTH),
    Cell("all", "step", f"{TRUTH}, {WRONG}"),
    Cell("all", "step", f"{SENSORS}, {WRONG}"),
)

measure = drawn_cases.measure


def name_of(cell: Cell, name: str) -> str:
    """Name of the draws of a law; equal torques know nothing."""
    if name == BASE:
        return f"{cell.car} {cell.manoeuvre} {BASE}"
    return f"{cell.car} {cell.manoeuvre} {cell.known} {name}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law in every cell, and equal torques beside them once."""
    found: dict[str, Case] = {}
    for cell in CELLS:
        setting = Setting(cell.car, cell.manoeuvre, ROAD_OF[cell.manoeuvre])
        wrong = cell.known.endswith(WRONG)
        for name in (BASE, *cell.laws):
            of_law = law(name, cell.known.partition(",")[0])
            for draw in range(DRAWS):
                one = f"{name_of(cell, name)}: {draw}"
                found.setdefault(one, drawn_cases.case(one, setting, draw, of_law, wrong))
    return list(found.values())


def values(results: Results, cell: Cell, name: str, quantity: str) -> np.ndarray:
    """Numbers measured on each draw, (draws,)."""
    return of_draws(results, name_of(cell, name), quantity)


def growth(results: Results, known: str, name: str) -> np.ndarray:
    """Growth of the tracking error in each draw by wrong tyres in the law, (draws,) [1]."""
    right = values(results, Cell("all", "step", known), name, "tracking")
    wrong = values(results, Cell("all", "step", f"{known}, {WRONG}"), name, "tracking")
    return wrong / right - 1.0


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Median growth of the tracking error by wrong tyres."""
    found = {}
    for known in (TRUTH, SENSORS):
        for name in CONTROLLERS:
            by_draw = growth(results, known, name)
            found[f"growth {name} {known}"] = metric(
                lambda by_draw=by_draw: float(np.median(by_draw)), "1"
            )
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Medians of each quantity by cell and law."""

    def shown(cell: Cell, name: str, quantity: str, factor: float) -> str:
        by_draw = factor * values(results, cell, name, quantity)
        is_measured = quantity != "angle" or cell.manoeuvre == "ramp"
        if not is_measured or not np.isfinite(by_draw).all():
            return "–"
        middle, low, high = interval(by_draw)
        return f"{middle:.1f} [{low:.1f}, {high:.1f}]"

    found = []
    for cell in CELLS:
        # Equal torques know nothing, so they stand once for each car and manoeuvre.
        names = (BASE, *cell.laws) if cell.known == TRUTH else cell.laws
        for name in names:
            known = "–" if name == BASE else cell.known
            numbers = (shown(cell, name, *each) for each in _SHOWN)
            found.append((cell.car, cell.manoeuvre, known, name, *numbers))
    return found
