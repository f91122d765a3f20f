"""Metrics of a CAN bus: load, latency, jitter and lost frames of each circuit."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ev_bench.bus.parameters import CIRCUITS
from ev_stack.measures.metric import LOWER, channel
from ev_stack.measures.named import DrivenRun, NamedMetric


def _of_a_bus(circuit: str) -> Iterable[NamedMetric]:
    load, latency, lost = (f"can.bus.{what}_{circuit}" for what in ("load", "latency", "lost"))

    def mean_load(run: DrivenRun) -> float:
        values = channel(run.signals, load)[1:]
        return float(values.mean()) if len(values) else 0.0

    def jitter(run: DrivenRun) -> float:
        carried = channel(run.signals, latency)
        carried = carried[carried > 0.0]
        return float(np.ptp(carried)) if len(carried) else 0.0

    name = f"bus_{circuit}_"
    yield NamedMetric(
        f"{name}load", "1", f"mean load of the {circuit} bus", mean_load, (load,), LOWER
    )
    yield NamedMetric(
        f"{name}longest_latency",
        "s",
        f"max latency on the {circuit} bus",
        lambda run: channel(run.signals, latency).max(),
        (latency,),
        LOWER,
    )
    yield NamedMetric(
        f"{name}latency_jitter",
        "s",
        "max - min latency of the periods that carried frames",
        jitter,
        (latency,),
        LOWER,
    )
    yield NamedMetric(
        f"{name}lost_frames",
        "1",
        f"frames lost on the {circuit} bus",
        lambda run: channel(run.signals, lost)[-1],
        (lost,),
        LOWER,
    )


METRICS = tuple(each for circuit in CIRCUITS for each in _of_a_bus(circuit))
