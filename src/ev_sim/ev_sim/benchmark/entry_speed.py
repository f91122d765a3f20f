"""The highest speed that a car drives clean, by bisection of the runs of all draws at once.

It is the entry speed of a manoeuvre, or the scale of the speed profile of a lap.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_sim.batches.by_period import batch_by_period
from ev_sim.benchmark.board import Board, Manoeuvre
from ev_sim.manoeuvres.double_lane_change import passed
from ev_sim.measures.handling import peak_sideslip
from ev_sim.measures.laps import lap_times
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.registry import DrivenRun, NamedMetric
from ev_sim.scenarios.scenario import Run

CLEAN = "clean"
_DRIVER = "driver"


def clean(board: Board, run: Run) -> NamedMetric:
    """Whether a run is: the car is stable, in its lanes or on its road to the end, and touches no cone."""
    parameters = {_DRIVER: run.configurations[_DRIVER].values()}

    def of(driven: DrivenRun) -> float:
        try:
            if driven.course is not None:
                in_lanes = len(lap_times(driven.signals, driven.vehicle, driven.course)) >= driven.course.laps
            else:
                in_lanes = passed(driven.signals, driven.vehicle, parameters, run.course)
        except NotMeasured:  # it has not come to the end
            return 0.0
        return float(in_lanes and peak_sideslip(driven.signals) < board.unstable)

    return NamedMetric(
        CLEAN, "1", "1: stable, in the lanes and on the road to the end, no cone hit, all laps driven; else 0", of, ()
    )


def at_speeds(speeds: np.ndarray) -> dict[str, list[Any]]:
    """What has to vary for the speeds of some runs (n,) [m/s], which their drivers keep."""
    return {
        f"{MASTER}.initial_speed": speeds.tolist(),
        f"{_DRIVER}.speed_profile.time": [[0.0]] * len(speeds),
        f"{_DRIVER}.speed_profile.speed": [[speed] for speed in speeds.tolist()],
    }


def at_scales(scales: np.ndarray) -> dict[str, list[Any]]:
    """What has to vary for the scales of the speed profile of some laps (n,) [1]."""
    return {f"{_DRIVER}.limit.scale": scales.tolist()}


def searched_at(manoeuvre: Manoeuvre, values: np.ndarray) -> dict[str, list[Any]]:
    """What has to vary for what a manoeuvre raises, a value for each run (n,); nothing if it raises nothing."""
    if manoeuvre.entry_speed:
        return at_speeds(values)
    return at_scales(values) if manoeuvre.speed_scale else {}


def highest_clean(
    board: Board, manoeuvre: Manoeuvre, run: Run, vary: Mapping[str, Iterable[Any]], threads: int | None
) -> dict[str, list[Any]]:
    """What has to vary for each draw to be driven at its highest clean speed, or at the lowest one if none is.

    Between a speed that was clean and one that was not the middle is driven, `halvings` times. Where cleanness comes
    and goes with the speed this finds one of its ends.
    """
    low, high = (np.full(board.draws, end) for end in manoeuvre.searched)
    for _ in range(manoeuvre.halvings):
        middle = 0.5 * (low + high)
        found = batch_by_period(
            run.configurations,
            manoeuvre.duration,
            {**vary, **searched_at(manoeuvre, middle)},
            metrics=[clean(board, run)],
            threads=threads,
        )
        is_clean = found.metrics[CLEAN] == 1.0
        low, high = np.where(is_clean, middle, low), np.where(is_clean, high, middle)
    return searched_at(manoeuvre, low)
