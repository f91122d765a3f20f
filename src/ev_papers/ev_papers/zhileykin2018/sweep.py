"""Drive force by steering angle with the controls of zhileykin2018 and readings of the law."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np

from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018.grid import ANGLES, FIXED, FORCES, LIMIT, REAR_DRIVE, SWEPT
from ev_papers.zhileykin2018.shares import SHARES
from ev_stack.figures.other_axes import number_map
from ev_stack.figures.panels import Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = (
    "Zhileykin 2018: drive force by steering angle on ice with snow, which controls spin the car"
)
COLUMNS = ("force [N]", "angle [deg]", *SWEPT)
HEADING = f"largest sideslip angle [deg], ** where it passes {math.degrees(LIMIT):g} deg"
LEFT = 0
SUMS = ("cases", "rear_drive_spins", "holds_", "calm_")

measure = grid.measure


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the drive; the grid is that of the page docs/zhileykin2018.md."""
    parser.add_argument(
        "--drive",
        choices=grid.DRIVES,
        default=grid.MOTORS,
        help="default: motors, as on the page",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control at every force and angle."""
    return grid.cases_of(SWEPT, grid.DRIVES[getattr(given, "drive", grid.MOTORS)])


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Numbers of cases: rear drive spins, a control holds, of those and of all, shares are calm."""
    spins = grid.spins(results)
    found = {
        "cases": metric(lambda: grid.SIZE, "1"),
        "rear_drive_spins": metric(spins.sum, "1"),
    }
    for name in SWEPT:
        holds = grid.holds(results, name)
        if name != REAR_DRIVE:
            found[f"holds_where_rear_drive_spins_{name}"] = metric((holds & spins).sum, "1")
        found[f"holds_{name}"] = metric(holds.sum, "1")
    # Only a law can make its shares go to and fro.
    for name in SWEPT:
        if name not in (REAR_DRIVE, FIXED):
            calm = [grid.is_calm(results, name, share) for share in SHARES]
            found[f"calm_{name}"] = metric(np.all(calm, axis=0).sum, "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Force, angle and largest sideslip angle [deg] by control; stars where the car spins."""

    def shown(peak: float) -> str:
        text = f"{math.degrees(peak):.1f}"
        return f"**{text}**" if peak >= LIMIT else text

    peaks = {control: grid.of_all(results, control) for control in SWEPT}
    found = []
    for row, force in enumerate(FORCES):
        for column, angle in enumerate(ANGLES):
            numbers = (shown(peaks[control][row, column]) for control in SWEPT)
            found.append((f"{force:g}", f"{angle:g}", *numbers))
    return found


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """A map of the largest sideslip angle for each control."""
    angles = ("road-wheel angle [deg]", [f"{angle:g}" for angle in ANGLES])
    forces = ("drive force [N]", [f"{force:g}" for force in FORCES])

    def of(control: str) -> Panel:
        title = f"{readable(control)}: largest sideslip angle [deg]"
        peaks = np.degrees(grid.of_all(results, control))
        return number_map(title, angles, forces, peaks, math.degrees(LIMIT))

    return {"sideslip": Sheet([of(control) for control in SWEPT])}
