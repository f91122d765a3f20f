"""The sweep with active front steering: the law alone, the steering alone, and both, which the source names."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018.grid import CONTROLS
from ev_papers.zhileykin2018.grid import LIMIT as LIMIT
from ev_stack.measures import motion
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Run
from ev_study.studies.study import Case, Results

ABOUT = "Zhileykin 2018: the sweep without and with active front steering, who holds with the law, the steering, both"
COLUMN = "steering_column"
HANDS, ADDED = "hands", "added"
STEERINGS = (HANDS, ADDED)
GAIN, ACCELERATION = 1.0, 3.0  # [s] and [m/s^2], the defaults of the column
QUANTITIES = {  # of the cases in which the car holds -> heading and digits
    "peak_sideslip": ("mean largest sideslip [deg]", 1),
    "turned": ("mean turn in 12 s [deg]", 0),
    "added": ("mean largest added angle [deg]", 1),
}
COLUMNS = (
    "torque",
    "front wheels",
    "holds of 40",
    *(heading for heading, _ in QUANTITIES.values()),
)
LEFT = 2
SUMS = ("holds_",)


def add_options(parser: argparse.ArgumentParser) -> None:
    """How the front wheels are steered; the grid is that of the page docs/zhileykin2018.md."""
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
    return [*grid.cases_of(CONTROLS, (), HANDS), *grid.cases_of(CONTROLS, added, ADDED)]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest sideslip [rad], turn of the car [rad], and the angle that is added to that of the hands at most [rad]."""
    hands = (
        channel(recording, motion.STEERING_WHEEL_ANGLE)
        / run.configurations[COLUMN].common.vehicle.steering_ratio
    )
    return {
        "peak_sideslip": peak_sideslip(recording),
        "turned": float(np.unwrap(motion.heading(recording))[-1]),
        "added": float(np.abs(channel(recording, motion.ROAD_WHEEL_ANGLE) - hands).max()),
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """In how many cases the car holds."""
    return {
        f"holds_{control}_{steering}": metric(
            lambda control=control, steering=steering: grid.holds(results, control, steering).sum(),
            "1",
        )
        for control in CONTROLS
        for steering in STEERINGS
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """How the torque is shared, how the front wheels are steered, and what came of it."""
    found = []
    for control in CONTROLS:
        for steering in STEERINGS:
            held = grid.holds(results, control, steering)
            of = [grid.of_all(results, control, key, steering)[held] for key in QUANTITIES]
            means = [
                f"{math.degrees(float(values.mean())):.{digits}f}" if len(values) else "–"
                for values, (_, digits) in zip(of, QUANTITIES.values(), strict=True)
            ]
            found.append((control, steering, str(held.sum()), *means))
    return found
