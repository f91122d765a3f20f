"""Metrics that a scenario's own file asks for: a reduction of a channel, NAME = REDUCTION(CHANNEL)."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.parameters.shown import quoted
from ev_msgs_py.parameters.values import unknown_name
from ev_sim.report.metric import Metric, metric
from ev_sim.report.samples import Runs, channel

REDUCTIONS = {
    "minimum": np.min,
    "maximum": np.max,
    "largest_magnitude": lambda values: np.abs(values).max(),
    "last": lambda values: values[-1],
    "mean": np.mean,
    "root_mean_square": lambda values: np.sqrt(np.mean(values * values)),
}
_FORM = re.compile(r"\s*(\w+)\s*=\s*(\w+)\s*\(\s*([\w.]+)\s*\)\s*")


def parsed(text: str) -> tuple[str, str, str]:
    """Name, reduction and channel of a metric; ParameterError if one of them is none."""
    found = _FORM.fullmatch(text)
    if found is None:
        raise ParameterError(f"metrics: {quoted(text)} is refused, allowed is NAME = REDUCTION(CHANNEL)")
    name, reduction, channel_name = found.groups()
    if reduction not in REDUCTIONS:
        raise unknown_name("reduction", reduction, REDUCTIONS)
    if channel_name not in frame.channels():
        raise unknown_name("channel", channel_name, frame.channels())
    return name, reduction, channel_name


def own_metrics(texts: Sequence[str], runs: Runs) -> dict[str, Metric]:
    """The metrics of each run; the name of the run stands in front if there are several."""
    found = {}
    for name, reduction, channel_name in map(parsed, texts):
        for run, recording in runs.items():
            key = f"{run}_{name}" if len(runs) > 1 else name
            found[key] = metric(
                lambda of=recording, reduce=REDUCTIONS[reduction], name=channel_name: reduce(channel(of, name)),
                frame.units()[channel_name],
            )
    return found
