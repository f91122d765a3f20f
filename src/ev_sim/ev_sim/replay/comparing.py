"""Answers beside the recorded ones, channel by channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_sim.replay.graph import Replay
from ev_sim.report.table_files import cell, write_tables
from ev_sim.report.text_table import text_table
from ev_sim.running.recording.recording import Recording


@dataclass(frozen=True, slots=True)
class Difference:
    """One channel, at the `compared` instants.

    `differing` of them are not bit-identical, the first one is number `step` at `time` [s], with the values
    `recorded` and `replayed`; None where all are identical. `largest` difference at `at` [s], and `rms` over all that
    were compared, in `unit`.
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


def differences_of(replay: Replay, replayed: Recording) -> tuple[Difference, ...]:
    """All channels that the role writes and that were recorded, at the instants of which both sides are known."""
    known = compared_instants(replay)[: len(replayed.time)]
    units = frame.units()
    return tuple(
        _difference(name, units[name], replay.recorded.recording.channels[name], replayed, known & came)
        for signal in replay.answers
        for came in [replay.recorded.came[TOPICS[signal]][: len(known)]]
        for name in TOPICS[signal].channels
    )


def compared_instants(replay: Replay) -> np.ndarray:
    """Whether what the role answers from was recorded (n,): of this instant, or where it integrates the one before."""
    came = replay.recorded.came
    there = np.ones(len(replay.recorded.recording.time), bool)
    for signal in replay.configuration.method.reads:
        if signal is not Instant:
            there &= came[TOPICS[signal]]
    if ROLES[replay.role].kind is RoleKind.INTEGRATES:
        return np.append([True], there[:-1])
    return there


def _difference(name: str, unit: str, before: np.ndarray, replayed: Recording, known: np.ndarray) -> Difference:
    values, before = replayed.channels[name], before[: len(known)]
    differ = np.flatnonzero(known & (values.view(np.int64) != before.view(np.int64)))
    apart = np.where(known, np.abs(values - before), 0.0)
    compared = int(np.sum(known))
    if not len(differ):
        return Difference(name, unit, compared, 0, None, None, None, None, 0.0, None, 0.0)
    first, most = int(differ[0]), int(np.argmax(apart))
    rms = float(np.sqrt(np.sum(apart**2) / compared))
    said = float(before[first]), float(values[first])
    begin, at = (float(replayed.time[place]) for place in (first, most))
    return Difference(name, unit, compared, len(differ), first, begin, *said, float(apart[most]), at, rms)


_SHOWN = ("channel", "unit", "differing", "step", "time", "recorded", "replayed", "largest", "at", "rms")


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
    first = min(differing, key=lambda d: (d.step or 0, found.index(d)))
    where = f"first {first.channel} in step {first.step} at {cell(first.time)} s"
    return f"{len(differing)} of {len(found)} channels differ, compared at {compared} instants; {where}"
