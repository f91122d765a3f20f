"""Sweep with active front steering: the law alone, the steering alone, and both.

The source names the combination and has no equations for it.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018.grid import CONTROLS
from ev_stack.measures import motion
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results

ABOUT = (
    "Zhileykin 2018: the sweep without and with active front steering, "
    "in how many cases the law, the steering and both hold the car"
)
COLUMN = "steering_column"
HANDS = "hands"
ADDED = "added"
STEERINGS = (HANDS, ADDED)
GAIN = 1.0  # [s], the default of the column
ACCELERATION = 3.0  # [m/s^2], the same
# Means over the cases in which the car holds: heading and digits.
QUANTITIES = {
    "peak_sideslip": ("mean largest sideslip [deg]", 1),
    "turned": ("mean turn in 12 s [deg]", 0),
    "added": ("mean largest added angle [deg]", 1),
}
HEADINGS = tuple(heading for heading, _ in QUANTITIES.values())
COLUMNS = ("torque", "front wheels", "holds of 40", *HEADINGS)
LEFT = 2
SUMS = ("holds_",)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add how the front wheels are steered; the grid is that of docs/zhileykin2018.md."""
    parser.add_argument(
        "--gain",
        type=float,
        default=GAIN,
        metavar="S",
        help="of active_front [s]; default: %(default)s",
    )
    parser.add_argument(
        "--acceleration",
        type=float,
        default=ACCELERATION,
        metavar="M/S2",
        help="across, that active_front takes the road to give; default: %(default)s",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control of the scenario with both steerings, at every force and angle."""
    added = (
        (COLUMN, "method", "active_front"),
        (COLUMN, "gain", getattr(given, "gain", GAIN)),
        (COLUMN, "largest_acceleration", getattr(given, "acceleration", ACCELERATION)),
    )
    by_hands = grid.cases_of(CONTROLS, (), HANDS)
    return [*by_hands, *grid.cases_of(CONTROLS, added, ADDED)]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest sideslip, turn of the car, and largest angle added to that of the hands [rad]."""
    vehicle = run.configurations[COLUMN].common.vehicle
    hands = channel(recording, motion.STEERING_WHEEL_ANGLE) / vehicle.steering_ratio
    added = channel(recording, motion.ROAD_WHEEL_ANGLE) - hands
    return {
        "peak_sideslip": peak_sideslip(recording),
        "turned": float(np.unwrap(motion.heading(recording))[-1]),
        "added": float(np.abs(added).max()),
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Number of cases in which the car holds."""
    found = {}
    for control in CONTROLS:
        for steering in STEERINGS:
            held = grid.holds(results, control, steering)
            found[f"holds_{control}_{steering}"] = metric(held.sum, "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Rows of torque sharing and front wheel steering with the means of those that hold."""
    found = []
    for control in CONTROLS:
        for steering in STEERINGS:
            held = grid.holds(results, control, steering)
            means = []
            for quantity, (_, digits) in QUANTITIES.items():
                values = grid.of_all(results, control, quantity, steering)[held]
                mean = f"{math.degrees(float(values.mean())):.{digits}f}" if len(values) else "–"
                means.append(mean)
            found.append((control, steering, str(held.sum()), *means))
    return found
