"""Answers beside the recorded ones, channel by channel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER, ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS
from ev_nodes.master.real_time import Histogram
from ev_stack.figures.other_axes import histograms
from ev_stack.figures.sheets import Sheet
from ev_stack.recording.recording import Recording
from ev_stack.report.tables import cell, text_table, write_tables
from ev_study.replay.recorded import Recorded

_JITTER, _LATENCY = "jitter", "latency"
_SHOWN = (
    "channel",
    "unit",
    "differing",
    "step",
    "time",
    "recorded",
    "replayed",
    "largest",
    "at",
    "rms",
)


def latency_of(recorded: Recorded) -> dict[str, Any]:
    """Jitter and latencies of a recorded run; empty where only stamps are known.

    `jitter` by topic, the first one of each role: by how much more or less than the control period
    two messages of successive instants were apart. `latency` by topic: how long after the last
    message that its role may read a message came, as the recorder took both; the plant keeps time
    and has none. Histograms as in `nodes/master/real_time.py`, and medians [s].
    """
    if not recorded.arrivals:
        return {}
    # A role writes all its topics at once, so the first one shows the interval of all.
    of_roles = [
        [TOPICS[signal] for signal in role.writes if recorded.has(signal)][:1]
        for role in ROLES.values()
    ]
    jitter = {}
    for topic in (topic for topics in of_roles for topic in topics):
        # Only two instants in a row with both messages have an interval.
        came, there = recorded.arrivals[topic], recorded.came[topic]
        jitter[topic.name] = _counted(
            np.abs(np.diff(came)[there[1:] & there[:-1]] - recorded.period)
        )
    return {_JITTER: jitter, _LATENCY: dict(_latencies(recorded))}


def _latencies(recorded: Recorded) -> Iterator[tuple[str, dict[str, Any]]]:
    for role in ROLES.values():
        reads = [TOPICS[signal] for signal in role.reads if recorded.has(signal)]
        # The master sets the pace and answers to nothing.
        if role.name == MASTER or not reads:
            continue
        # An answer cannot come before the last of its inputs.
        last_input = np.max([recorded.arrivals[topic] for topic in reads], axis=0)
        known = np.all([recorded.came[topic] for topic in reads], axis=0)
        # What integrates answers inputs of t_k with a state that has the stamp t_k+1.
        ahead = int(role.kind is RoleKind.INTEGRATES)
        for topic in (TOPICS[signal] for signal in role.writes if recorded.has(signal)):
            count = len(known) - ahead
            both = known[:count] & recorded.came[topic][ahead:]
            yield (
                topic.name,
                _counted((recorded.arrivals[topic][ahead:] - last_input[:count])[both]),
            )


def _counted(nanoseconds: np.ndarray) -> dict[str, Any]:
    histogram = Histogram()
    for time in (nanoseconds / 1e9).tolist():
        histogram.add(time)
    median = float(np.median(nanoseconds)) / 1e9 if len(nanoseconds) else None
    return {**histogram.as_json(), "median": median}


def latency_sheet(timing: Mapping[str, Any]) -> Sheet:
    """Both as histograms."""
    titles = {
        _JITTER: "interval of messages, beside the period",
        _LATENCY: "answer after the last of its inputs",
    }
    return Sheet([histograms(titles[what], timing[what]) for what in (_JITTER, _LATENCY)])


def latencies_in_words(timing: Mapping[str, Any], topics: list[str]) -> list[str]:
    """A line for each of the topics."""
    lines = []
    for topic in topics:
        found = {what: timing[what].get(topic, {}) for what in (_LATENCY, _JITTER)}
        parts = [
            f"{what} {1e3 * times['median']:.3g} ms of half, {1e3 * times['largest']:.3g} ms at"
            " most"
            for what, times in found.items()
            if times.get("median") is not None
        ]
        if parts:
            lines.append(f"{topic}: {'; '.join(parts)}")
    return lines


@dataclass(frozen=True, slots=True)
class Difference:
    """One channel, at the `compared` instants.

    `differing` of them are not bit-identical, the first one is number `step` at `time` [s], with
    the values `recorded` and `replayed`; None where all are identical. `largest` difference at `at`
    [s], and `rms` over all that were compared, in `unit`.
    """

    channel: str
    unit: str
    compared: int
    differing: int
    step: int | None
    time: float | None
    recorded: float | None
    replayed: float | None
    largest: float
    at: float | None
    rms: float


def difference_of(
    name: str, unit: str, before: np.ndarray, replayed: Recording, known: np.ndarray
) -> Difference:
    """That of a channel from its recorded values, (n,), at the `known` instants, (n,)."""
    # A shorter replay is compared as far as it goes.
    values, before = replayed.channels[name], before[: len(known)]
    # As integers, so that NaN equals itself and -0.0 differs from 0.0: bits, not values.
    differ = np.flatnonzero(known & (values.view(np.int64) != before.view(np.int64)))
    apart = np.where(known, np.abs(values - before), 0.0)
    compared = int(np.sum(known))
    if not len(differ):
        return Difference(name, unit, compared, 0, None, None, None, None, 0.0, None, 0.0)
    first, most = int(differ[0]), int(np.argmax(apart))
    rms = float(np.sqrt(np.sum(apart**2) / compared))
    pair = float(before[first]), float(values[first])
    begin, at = (float(replayed.time[place]) for place in (first, most))
    return Difference(
        name, unit, compared, len(differ), first, begin, *pair, float(apart[most]), at, rms
    )


def table_of(found: Sequence[Difference]) -> str:
    """The channels that differ, in aligned columns; empty if all are identical."""
    rows = [[cell(getattr(each, name)) for name in _SHOWN] for each in found if each.differing]
    return text_table(_SHOWN, rows, left=("channel", "unit")) if rows else ""


def table_files(found: Sequence[Difference], folder: Path) -> None:
    """All channels as table.csv and so on, with all digits."""
    columns = [each.name for each in fields(Difference)]
    write_tables(folder, columns, [[getattr(each, name) for name in columns] for each in found])


def in_words(found: Sequence[Difference]) -> str:
    """One line on all channels together."""
    compared = max(d.compared for d in found)
    differing = [d for d in found if d.differing]
    if not differing:
        return f"bit-identical: {len(found)} channels at {compared} instants"
    # The first step counts; in one step the first channel in the order of the topics.
    first = min(differing, key=lambda d: (d.step or 0, found.index(d)))
    where = f"first {first.channel} in step {first.step} at {cell(first.time)} s"
    return (
        f"{len(differing)} of {len(found)} channels differ, compared at {compared} instants;"
        f" {where}"
    )
