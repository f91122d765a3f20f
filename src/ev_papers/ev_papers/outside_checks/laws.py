"""Controllers, references and allocations on known friction: understeer, tracking, sideslip, energy, wrong tyres.

M. Asperti, M. Vignati, E. Sabbioni (2024), On torque vectoring control: review and comparison of state-of-the-art
approaches, Machines 12(3), 160; De Novellis et al. (2014) as in `friction`; "System-level performance of torque
vectoring controllers", SAE 10-10-04-0029.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np

from ev_papers.outside_checks import cases as drawn_cases
from ev_papers.outside_checks.cases import (
    BASE,
    CONTROLLERS,
    DRAWS,
    SENSORS,
    TRUTH,
    interval,
    law,
    of_draws,
)
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = "Asperti 2024 and others: torque vectoring part by part on known friction, and with wrong tyres given"
WRONG = "wrong tyres"
ROAD_OF = {"ramp": "dry", "step": "dry", "sine": "wet", "lane_change": "snow"}
EVERY = (*CONTROLLERS, "pi_neutral", "pi_load", "pi_least_squares")
# Car, manoeuvre, what is known, laws.
CELLS = (
    *(("all", manoeuvre, known, EVERY) for manoeuvre in ROAD_OF for known in (TRUTH, SENSORS)),
    *(
        (car, manoeuvre, TRUTH, CONTROLLERS)
        for car in ("front", "rear")
        for manoeuvre in ("step", "sine")
    ),
    *(("all", "step", f"{known}, {WRONG}", CONTROLLERS) for known in (TRUTH, SENSORS)),
)
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
HEADING = "medians of the draws with their 95 % intervals; angle: of the steering wheel on the ramp at 4 m/s^2"
LEFT = 4
SUMS = ()


def name_of(car: str, manoeuvre: str, known: str, name: str) -> str:
    """Name of the draws of a law; equal torques know nothing."""
    return f"{car} {manoeuvre} {BASE}" if name == BASE else f"{car} {manoeuvre} {known} {name}"


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every law in every cell, and equal torques beside them once."""
    found: dict[str, Case] = {}
    for car, manoeuvre, known, laws in CELLS:
        for name in (BASE, *laws):
            for draw in range(DRAWS):
                one = f"{name_of(car, manoeuvre, known, name)}: {draw}"
                of_law = law(name, known.partition(",")[0])
                wrong = known.endswith(WRONG)
                found.setdefault(
                    one,
                    drawn_cases.case(one, car, manoeuvre, ROAD_OF[manoeuvre], draw, of_law, wrong),
                )
    return list(found.values())


measure = drawn_cases.measure


def values(
    results: Results, car: str, manoeuvre: str, known: str, name: str, quantity: str
) -> np.ndarray:
    """What was measured on each draw, (draws,)."""
    return of_draws(results, name_of(car, manoeuvre, known, name), quantity)


def growth(results: Results, known: str, name: str) -> np.ndarray:
    """By what the tracking error grows in each draw where the law believes in wrong tyres, (draws,) [1]."""
    right, wrong = (
        values(results, "all", "step", each, name, "tracking")
        for each in (known, f"{known}, {WRONG}")
    )
    return wrong / right - 1.0


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The median growth of the tracking error by wrong tyres."""
    return {
        f"growth {name} {known}": metric(
            lambda name=name, known=known: float(np.median(growth(results, known, name))), "1"
        )
        for known in (TRUTH, SENSORS)
        for name in CONTROLLERS
    }


_SHOWN = (
    ("tracking", 1e3),
    ("sideslip", math.degrees(1.0)),
    ("energy", 1e-3),
    ("angle", math.degrees(1.0)),
)


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """The medians of each quantity by cell and law."""
    found = []
    for car, manoeuvre, known, laws in CELLS:
        for name in (BASE, *laws) if known == TRUTH else laws:
            line = []
            for quantity, factor in _SHOWN:
                of = factor * values(results, car, manoeuvre, known, name, quantity)
                middle, low, high = interval(of) if np.isfinite(of).all() else (math.nan,) * 3
                is_shown = math.isfinite(middle) and (quantity != "angle" or manoeuvre == "ramp")
                line.append(f"{middle:.1f} [{low:.1f}, {high:.1f}]" if is_shown else "–")
            found.append((car, manoeuvre, "–" if name == BASE else known, name, *line))
    return found
