"""Time of a step of a law: a reading of this machine's clock, and so no part of any hash."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from ev_core.compiled.loop import Parts, run_instants
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import method_part
from ev_core.lockstep.run import GraphRun
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import MASTER
from ev_study.benchmark.board import Board, Cell, by_role
from ev_study.benchmark.cell_runs import law_of, run_of, values_of, with_law

REPETITIONS = 9


def step_times(board: Board, cell: Cell, laws: Sequence[str]) -> dict[str, float]:
    """CPU time of a step of each law with all its roles [ns], in the run of a cell with the nominal car.

    Each role answers in the compiled loop to the inputs that it had in the run: the least mean of
    some repetitions.
    """
    base, found = run_of(board, cell, values_of(board, cell)), {}
    for law in laws:
        run = with_law(base, law_of(board, law, base))
        period = run.configurations[MASTER].period
        graph = GraphRun(run.configurations, stamps.from_seconds(run.duration) // period + 1)
        # Fills the series with the inputs that each role had.
        graph.drive(lambda _: None, lambda role, text: None)
        found[law] = sum(
            _step_time(run.configurations[role], graph.series) for role in by_role(board.laws[law])
        )
    return found


def _step_time(configuration: Configuration, series: np.ndarray) -> float:
    frames, times = np.ascontiguousarray(series.T), []
    for _ in range(REPETITIONS):
        # A new part each time: its state begins anew, so all repetitions do the same work.
        part = method_part(configuration, compiled=True)
        rows = np.array([(*part.addresses(), *frame.span(configuration.method.writes))], np.int64)
        # CPU time of this thread: waiting for a busy machine does not count.
        begin = time.thread_time_ns()
        run_instants(frames, 0, len(frames) - 1, True, Parts(rows, 1), np.zeros(2, np.int64))
        times.append(time.thread_time_ns() - begin)
    # The least: what disturbs a repetition only makes it longer.
    return min(times) / len(frames)
