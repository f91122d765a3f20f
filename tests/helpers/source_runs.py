"""Runs of the scenarios of the sources, each driven once for all tests."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np

from documentation.results import Driven, drive
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.metric import Metric
from ev_stack.recording.recording import Recording

# Channels that change their sign when left and right change places; all others keep it.
ODD = (
    ".lateral",
    "lateral_acceleration",
    "lateral_force",
    "slip_angle",
    "yaw_rate",
    "pose.y",
    "orientation_z",
    "steering_column.state",
    "hand_torque",
)


@cache
def driven(scenario: str) -> Driven:
    """All runs of a scenario as its file has them."""
    return drive(scenario)


@cache
def metrics_of(scenario: str) -> Mapping[str, Metric]:
    """The metrics of those runs."""
    return driven(scenario).metrics


def value(scenario: str, name: str) -> float:
    """The number of a metric that must have been measured."""
    metric = metrics_of(scenario)[name]
    assert metric.value is not None, metric.verdict
    return metric.value


def mirrored(run: Recording) -> Recording:
    """The run as seen in a mirror along the car."""
    swap = {"left": "right", "right": "left"}

    def partner(channel: str) -> str:
        stem, _, wheel = channel.rpartition(".")
        if wheel not in WHEEL_NAMES:
            return channel
        return f"{stem}.{'_'.join(swap.get(part, part) for part in wheel.split('_'))}"

    def sign(channel: str) -> float:
        return -1.0 if any(part in channel for part in ODD) else 1.0

    return Recording(
        run.time, {name: sign(name) * run.channels[partner(name)] for name in run.channels}
    )


def differing(one: Recording, other: Recording) -> list[str]:
    """Names of the channels that are not equal; a zero may have either sign."""
    return [
        name
        for name in one.channels
        if not np.array_equal(one.channels[name], other.channels[name])
    ]
