"""Drive force by steering angle for the controls of the scenario zhileykin2018 and readings of the law: who spins."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np

from ev_papers.zhileykin2018 import grid as grid
from ev_papers.zhileykin2018.grid import ANGLES, FIXED, FORCES, LIMIT, REAR_DRIVE, SHARES, SWEPT
from ev_stack.figures.other_axes import number_map
from ev_stack.figures.panels import readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = (
    "Zhileykin 2018: drive force by steering angle on ice with snow, who spins with which control"
)
COLUMNS = ("force [N]", "angle [deg]", *SWEPT)
HEADING = f"largest sideslip angle [deg], ** where it passes {math.degrees(LIMIT):g} deg"
LEFT = 0
SUMS = ("cases", "rear_drive_spins", "holds_", "calm_")


def add_options(parser: argparse.ArgumentParser) -> None:
    """The drive; the grid is that of the page docs/zhileykin2018.md."""
    parser.add_argument(
        "--drive", choices=grid.DRIVES, default=grid.MOTORS, help="default: motors, as on the page"
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control at every force and angle."""
    return grid.cases_of(SWEPT, grid.DRIVES[getattr(given, "drive", grid.MOTORS)])


measure = grid.measure


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """In how many cases rear drive spins, each other control holds, of those and of all, and all shares are calm."""
    found = {
        "cases": metric(lambda: grid.SIZE, "1"),
        "rear_drive_spins": metric(lambda: grid.spins(results).sum(), "1"),
    }
    for name in SWEPT:
        if name != REAR_DRIVE:
            found[f"holds_where_rear_drive_spins_{name}"] = metric(
                lambda name=name: (grid.holds(results, name) & grid.spins(results)).sum(), "1"
            )
        found[f"holds_{name}"] = metric(lambda name=name: grid.holds(results, name).sum(), "1")
    for name in SWEPT:
        if name in (REAR_DRIVE, FIXED):
            continue
        found[f"calm_{name}"] = metric(
            lambda name=name: np.all(
                [grid.is_calm(results, name, share) for share in SHARES], axis=0
            ).sum(),
            "1",
        )
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Force, angle and the largest sideslip angle [deg] with each control; two stars where the car spins."""

    def shown(peak: float) -> str:
        return f"**{math.degrees(peak):.1f}**" if peak >= LIMIT else f"{math.degrees(peak):.1f}"

    found = {control: grid.of_all(results, control) for control in SWEPT}
    return [
        (f"{force:g}", f"{angle:g}", *(shown(found[control][i, j]) for control in SWEPT))
        for i, force in enumerate(FORCES)
        for j, angle in enumerate(ANGLES)
    ]


def figures(given: argparse.Namespace, results: Results) -> dict[str, Sheet]:
    """A map of the largest sideslip angle for each control."""
    columns = "road-wheel angle [deg]", [f"{angle:g}" for angle in ANGLES]
    rows = "drive force [N]", [f"{force:g}" for force in FORCES]
    return {
        "who_spins": Sheet(
            [
                number_map(
                    f"{readable(control)}: largest sideslip angle [deg]",
                    columns,
                    rows,
                    np.degrees(grid.of_all(results, control)),
                    math.degrees(LIMIT),
                )
                for control in SWEPT
            ]
        )
    }
