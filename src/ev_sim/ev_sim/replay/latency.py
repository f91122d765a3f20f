"""When messages came, of a bag that knows it: how even the steps were, and how long answers took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER, ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.nodes.histogram import Histogram
from ev_sim.replay.recorded import Recorded
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.timing import histogram_sheet

_JITTER, _LATENCY = "jitter", "latency"


def latency_of(recorded: Recorded) -> dict[str, Any]:
    """Jitter and latencies of a recorded run; empty where only stamps are known.

    `jitter` by topic, of each role its first: by how much more or less than the control period two messages of
    successive instants were apart.
    `latency` by topic: how long after the last message that its role may read a message came, as the recorder heard
    both; of the plant, which keeps time, there is none. Histograms as in `nodes/histogram.py`, and medians [s].
    """
    if not recorded.arrivals:
        return {}
    of_roles = [[TOPICS[signal] for signal in role.writes if recorded.has(signal)][:1] for role in ROLES.values()]
    jitter = {topic.name: _counted(np.abs(_intervals(recorded, topic))) for topics in of_roles for topic in topics}
    return {_JITTER: jitter, _LATENCY: dict(_latencies(recorded))}


def _intervals(recorded: Recorded, topic: Topic) -> np.ndarray:
    came, there = recorded.arrivals[topic], recorded.came[topic]
    both = there[1:] & there[:-1]
    apart: np.ndarray = np.diff(came)[both] - recorded.period
    return apart


def _latencies(recorded: Recorded) -> Iterator[tuple[str, dict[str, Any]]]:
    for role in ROLES.values():
        reads = [TOPICS[signal] for signal in role.reads if recorded.has(signal)]
        if role.name == MASTER or not reads:
            continue
        last_input = np.max([recorded.arrivals[topic] for topic in reads], axis=0)
        known = np.all([recorded.came[topic] for topic in reads], axis=0)
        ahead = int(role.kind is RoleKind.INTEGRATES)
        for topic in (TOPICS[signal] for signal in role.writes if recorded.has(signal)):
            count = len(known) - ahead
            both = known[:count] & recorded.came[topic][ahead:]
            yield topic.name, _counted((recorded.arrivals[topic][ahead:] - last_input[:count])[both])


def _counted(nanoseconds: np.ndarray) -> dict[str, Any]:
    histogram = Histogram()
    for time in (nanoseconds / 1e9).tolist():
        histogram.add(time)
    median = float(np.median(nanoseconds)) / 1e9 if len(nanoseconds) else None
    return {**histogram.as_json(), "median": median}


def latency_sheet(timing: Mapping[str, Any]) -> Figure:
    """Both as histograms."""
    titles = {_JITTER: "interval of messages, beside the period", _LATENCY: "answer after the last of its inputs"}
    return histogram_sheet([[(titles[what], timing[what]) for what in (_JITTER, _LATENCY)]])


def in_words(timing: Mapping[str, Any], topics: list[str]) -> list[str]:
    """A line for each of the topics."""
    lines = []
    for topic in topics:
        said = []
        for what in (_LATENCY, _JITTER):
            if topic in timing[what] and timing[what][topic]["median"] is not None:
                times = timing[what][topic]
                said.append(f"{what} {1e3 * times['median']:.3g} ms of half, {1e3 * times['largest']:.3g} ms at most")
        if said:
            lines.append(f"{topic}: {'; '.join(said)}")
    return lines
