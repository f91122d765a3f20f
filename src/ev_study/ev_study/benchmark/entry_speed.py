"""The highest speed that a car drives clean, looked for in the runs of all draws at once.

It is the entry speed of a manoeuvre, or the scale of the speed profile of a lap.

How it works: speeds are places on an even grid. One search runs for all draws at once: each batch
drives those draws that are still open, each at a place of its own, and ends every run as soon as it
is known whether it is clean. The last clean run of a draw is its result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_sim.driver.path import PathParameters
from ev_stack.batches.by_period import batch_by_period
from ev_stack.batches.whole_runs import Ending
from ev_stack.manoeuvres.double_lane_change import is_over, passed
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.laps import lap_times, laps_begun, leaves
from ev_stack.measures.metric import NotMeasured
from ev_stack.measures.named import DrivenRun, NamedMetric
from ev_stack.scenarios.records import Run
from ev_study.benchmark.board import Board
from ev_study.benchmark.manoeuvre import Manoeuvre

CLEAN, HASH, END = "clean", "signal hash", "end of run"
DRIVEN = "runs_driven"  # until the speed of a draw was found
# metrics, and by these names whether runs are clean, and when they ended [s], (runs,)
Driven = dict[str, np.ndarray]
_DRIVER = "driver"
_FRICTION = "road.own_c1"
_FIRST_STEP = 2  # of 64 speeds: what draws change beside that
# [s], between two looks at a run: at a lap one costs as much as 0.6 s of it
_LOOK, _LOOK_AT_LAP = 1.0, 5.0


def clean(board: Board, run: Run) -> NamedMetric:
    """Return a measure of clean runs: stable, in lanes or on the road, no cone touched."""

    def of(driven: DrivenRun) -> float:
        try:
            if driven.course is not None:
                in_lanes = (
                    len(lap_times(driven.signals, driven.vehicle, driven.course))
                    >= driven.course.laps
                )
            else:
                # No course of laps: the lanes and cones of the manoeuvre.
                in_lanes = passed(driven.signals, driven.vehicle, _road(driven), run.course)
        except NotMeasured:  # it has not come to the end
            return 0.0
        return float(in_lanes and peak_sideslip(driven.signals) < board.unstable)

    return NamedMetric(
        CLEAN,
        "1",
        "1: stable, in the lanes and on the road to the end, no cone hit, all laps driven; else 0",
        of,
        (),
    )


def _road(driven: DrivenRun) -> PathParameters | None:
    """The path of the driver of this very run, in the middle of the road; None if he has none."""
    return getattr(driven.driver, "path", None)


def _ending(board: Board, manoeuvre: Manoeuvre, run: Run) -> Ending:
    """Runs end when they are not clean any more, or at the end of lanes and laps: nothing behind it counts."""

    def known(driven: DrivenRun, since: int) -> bool:
        signals, vehicle, course = driven.signals, driven.vehicle, driven.course
        new = signals.part(since)
        # Only what is new since the last look: the rest was looked at then.
        if peak_sideslip(new) >= board.unstable:
            return True
        if course is None:
            return is_over(signals, since, vehicle, _road(driven), run.course)
        return (
            leaves(new, vehicle, course) is not None
            or laps_begun(signals, vehicle, course) > course.laps
        )

    return Ending(known, _LOOK_AT_LAP if manoeuvre.speed_scale else _LOOK)


def drive(
    board: Board,
    manoeuvre: Manoeuvre,
    run: Run,
    vary: Mapping[str, Sequence[Any]],
    threads: int | None,
) -> Driven:
    """Drive a law in a manoeuvre, a run for each row of what varies.

    Where a speed is looked for a run ends before its duration once it is known whether it is clean.
    """
    metrics = list(manoeuvre.measured)
    ending = None
    if manoeuvre.searched:
        metrics.append(clean(board, run))
        ending = _ending(board, manoeuvre, run)
    found = batch_by_period(
        run.configurations,
        manoeuvre.duration,
        vary,
        metrics=metrics,
        threads=threads,
        hashes=True,
        ending=ending,
    )
    return {**found.metrics, HASH: np.array(found.hashes, object), END: found.ends}


def at_speeds(speeds: np.ndarray) -> dict[str, list[Any]]:
    """Values that vary for the speeds of some runs (n,) [m/s], which their drivers keep."""
    return {
        f"{MASTER}.initial_speed": speeds.tolist(),
        f"{_DRIVER}.speed_profile.time": [[0.0]] * len(speeds),
        f"{_DRIVER}.speed_profile.speed": [[speed] for speed in speeds.tolist()],
    }


def at_scales(scales: np.ndarray) -> dict[str, list[Any]]:
    """Values that vary for the scales of the speed profile of some laps (n,) [1]."""
    return {f"{_DRIVER}.limit.scale": scales.tolist()}


def searched_at(manoeuvre: Manoeuvre, values: np.ndarray) -> dict[str, list[Any]]:
    """Values that vary with the raised quantity of a manoeuvre (n,); none if it raises nothing."""
    if manoeuvre.entry_speed:
        return at_speeds(values)
    return at_scales(values) if manoeuvre.speed_scale else {}


def at_highest_clean(
    board: Board,
    manoeuvre: Manoeuvre,
    run: Run,
    vary: Mapping[str, Sequence[Any]],
    threads: int | None,
) -> tuple[dict[str, list[Any]], Driven]:
    """Drive each draw at its highest clean speed, at the lowest one if none is clean.

    Return the values that vary for that, and the results. Speeds are the lower bound and
    2^`halvings` - 1 more, evenly; the upper bound is not driven. Each draw begins at what the run
    without draws reaches, times the root of its factor on the friction, as speeds in bends go.
    Where cleanness comes and goes with the speed this finds one of its ends. A manoeuvre that
    raises nothing is just driven.
    """
    if not manoeuvre.searched:
        return {}, drive(board, manoeuvre, run, vary, threads)
    lowest, highest = manoeuvre.searched
    count = 2**manoeuvre.halvings
    tries = np.zeros(board.draws)
    best: Driven = {}

    def speeds(places: np.ndarray) -> np.ndarray:
        return lowest + (highest - lowest) * places / count

    def driven_at(places: np.ndarray, columns: Mapping[str, Sequence[Any]]) -> Driven:
        at = {**columns, **searched_at(manoeuvre, speeds(places))}
        return drive(board, manoeuvre, run, at, threads)

    def is_clean_at(draws: np.ndarray, places: np.ndarray) -> np.ndarray:
        # Only the draws that are asked for; the batch has no others.
        columns = {name: [column[draw] for draw in draws.tolist()] for name, column in vary.items()}
        found = driven_at(places, columns)
        is_clean: np.ndarray = found[CLEAN] == 1.0
        tries[draws] += 1.0
        # At the lowest place a run counts in any case: there is no slower one.
        taken = is_clean | (places == 0)
        for name, of in found.items():
            # Clean places only rise within a search, so what was written last is the fastest.
            best.setdefault(name, np.empty(board.draws, of.dtype))[draws[taken]] = of[taken]
        return is_clean

    def is_nominal_clean_at(_: np.ndarray, places: np.ndarray) -> np.ndarray:
        is_clean: np.ndarray = driven_at(places, {})[CLEAN] == 1.0
        return is_clean

    # First the run without draws, from the middle of the range: where to begin for all draws.
    nominal = speeds(last_true(count, np.array([count // 2]), is_nominal_clean_at))
    # v^2/R at the limit is in proportion to the friction.
    expected = nominal * np.sqrt(_friction_factors(board, run, vary))
    start = (expected - lowest) / (highest - lowest) * count
    places = last_true(count, np.rint(start).astype(int), is_clean_at)
    # The search never asks for place 0, so these draws have not been driven at it.
    never = np.flatnonzero(places == 0)
    if never.size:
        is_clean_at(never, places[never])
    return searched_at(manoeuvre, speeds(places)), {**best, DRIVEN: tries}


def _friction_factors(board: Board, run: Run, vary: Mapping[str, Sequence[Any]]) -> np.ndarray:
    """Friction of each draw over that of the run without draws, (draws,)."""
    columns = vary.get(f"{MASTER}.{_FRICTION}")
    if columns is None:
        return np.ones(board.draws)
    # All surfaces have the same factor, so the first one shows it.
    without = run.configurations[MASTER].values()[_FRICTION][0]
    return np.array([column[0] for column in columns]) / without


def last_true(
    count: int, start: np.ndarray, is_true: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Find for each row the last of the places 0..count-1 at which something is true, (rows,).

    It is 0 if at none. `is_true` is asked for some rows at a place for each. True is expected up to
    a place and false behind it, near `start`: from there on in growing steps, and then by halves
    (Bentley & Yao 1976, Inf. Process. Lett. 5, 82-87).
    """
    low = np.zeros(len(start), int)
    high = np.full(len(start), count)
    # Place 0 is the answer where nothing is true, and needs no question.
    at = np.clip(start, 1, count - 1)
    step = _FIRST_STEP
    while (asked := np.flatnonzero(high - low > 1)).size:
        found = is_true(asked, at[asked])
        # Invariant: true at low (or low is 0), false at high (or high is count).
        low[asked] = np.where(found, at[asked], low[asked])
        high[asked] = np.where(found, high[asked], at[asked])
        # Up or down as long as one end is that of all places, then the middle.
        down_or_middle = np.where(low == 0, high - step, (low + high) // 2)
        at = np.where(high == count, low + step, down_or_middle)
        at = np.clip(at, low + 1, high - 1)
        # Doubling: an expectation that is far off costs a few runs more, not all of them.
        step *= 2
    return low
