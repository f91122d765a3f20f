"""Reading recorded samples for a metric, and the metrics that a scenario's own file asks for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.measures.metric import Metric, NotMeasured, metric
from ev_sim.recording.recording import Recording

Runs = Mapping[str, Recording]  # name of the run -> its signals
Parameters = Mapping[str, Mapping[str, Any]]  # node -> dotted parameter name -> value
TYRES = "tire_forces."  # begins the channels that only a plant with tyres has


def run_named(runs: Runs, name: str) -> Recording:
    """The run of a scenario; NotMeasured if it was not driven."""
    if name not in runs:
        raise NotMeasured(f"there is no run {name}")
    return runs[name]


def channel(recording: Recording, name: str) -> np.ndarray:
    """The samples of a channel, (n,); NotMeasured if the channel is missing, empty, not finite or not the truth."""
    if name in recording.unknown:
        raise NotMeasured(f"{name} was recorded as its sensor shows it, and what is true is not known")
    if name not in recording.channels:
        raise NotMeasured("the plant has no tyres" if name.startswith(TYRES) else f"{name} was not recorded")
    values = recording.channels[name]
    if not len(values):
        raise NotMeasured("the run has no samples")
    if not np.isfinite(values).all():
        raise NotMeasured(f"{name} is not finite at {recording.time[~np.isfinite(values)][0]:g} s")
    return values


def mean_between(recording: Recording, values: np.ndarray, start: float, end: float) -> float:
    """Mean over start <= time < end [s]; NotMeasured if the run does not cover the window.

    The end is left out because at this instant the driver already answers to what comes next.
    """
    time = recording.time
    if not len(time):
        raise NotMeasured("the run has no samples")
    # Stamps are multiples of the period: rounding must not move a sample over the edge of the window.
    rounding = 1e-9
    if time[0] > start + rounding or time[-1] < end - rounding:
        raise NotMeasured(
            f"the run lasts from {time[0]:g} s to {time[-1]:g} s, the window from {start:g} s to {end:g} s"
        )
    inside = (time >= start - rounding) & (time < end - rounding)
    if not inside.any():
        raise NotMeasured(f"there is no sample from {start:g} s to {end:g} s")
    return float(values[inside].mean())


def last(recording: Recording, window: float) -> tuple[float, float]:
    """Start and end of the last `window` seconds of the run [s]."""
    if not len(recording.time):
        raise NotMeasured("the run has no samples")
    end = float(recording.time[-1])
    return end - window, end


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
