"""The graph without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Collection, Mapping
from itertools import accumulate
from operator import itemgetter
from typing import Any

import numpy as np

from ev_msgs_py import stamps
from ev_msgs_py.configuration import Configuration, check_graph
from ev_msgs_py.graph import step_order
from ev_msgs_py.notes import Notes
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.signals import Instant
from ev_msgs_py.topics import TOPICS
from ev_sim.recording.recording import Recording

Progress = Callable[[float], None]
_PROGRESS_STEPS = 100


class _Player:
    """The object of one role among the signals of the present instant, and the numbers of all that it has said."""

    def __init__(self, configuration: Configuration, made: Any, now: dict[type, Any]) -> None:
        self._object = made
        self._notes = Notes()
        self._reports = getattr(made, "reports", None)
        self._heard_of = _inputs(configuration.method.reads)
        self._writes = [
            (signal, TOPICS[signal].codec.carried, TOPICS[signal].codec.shape.flat, array("d"))
            for signal in configuration.method.writes
        ]
        self._now = now

    def show(self) -> None:
        """Put the outputs of an integrating object among the signals, and keep them.

        SignalError, before anybody goes on with them, if one is not finite.
        """
        now = self._now
        for (kind, carried, flat, numbers), signal in zip(self._writes, self._object.outputs(), strict=True):
            now[kind] = signal = carried(signal)
            numbers.extend(flat(signal))

    def answer(self) -> None:
        """Put the answer to the present signals among them, and keep it; SignalError as above."""
        now = self._now
        kind, carried, flat, numbers = self._writes[0]
        now[kind] = signal = carried(self._object.step(*self._heard_of(now)))
        numbers.extend(flat(signal))

    @property
    def speaks(self) -> bool:
        """Whether the object ever has something to say besides its signals."""
        return self._reports is not None

    def notes(self) -> list[str]:
        """What the object has to say for the first time."""
        return self._notes.new(self._object) if self._reports() else []

    def advance(self) -> None:
        """Integrate with the present signals to the next instant."""
        self._object.advance(*self._heard_of(self._now))

    def channels(self) -> dict[str, np.ndarray]:
        """All that it has said, by channel."""
        return {
            channel: column
            for kind, _, _, numbers in self._writes
            if (names := TOPICS[kind].channels)
            for channel, column in zip(names, np.array(numbers).reshape(-1, len(names)).T, strict=True)
        }


def _inputs(reads: tuple[type, ...]) -> Callable[[Mapping[type, Any]], tuple[Any, ...]]:
    """Picks what a method reads out of the present signals, in the order of its arguments."""
    if len(reads) == 1:
        (only,) = reads
        return lambda now: (now[only],)
    return itemgetter(*reads) if reads else lambda now: ()


class _RowPlayer(_Player):
    """The same for an integrating object with a `row`: signals that nobody reads are not made."""

    def __init__(
        self, configuration: Configuration, made: Any, now: dict[type, Any], heard: Collection[type]
    ) -> None:
        super().__init__(configuration, made, now)
        self._row = made.row
        self._rows: list[np.ndarray] = []
        shapes = [TOPICS[signal].codec.shape for signal in configuration.method.writes]
        ends = list(accumulate(len(shape.channels) for shape in shapes))
        places = zip(configuration.method.writes, shapes, [0, *ends], ends, strict=False)
        self._heard = [(kind, shape.signal_of, begin, end) for kind, shape, begin, end in places if kind in heard]

    def show(self) -> None:
        numbers = self._row.tolist()
        if not math.isfinite(sum(numbers)):
            super().show()  # knows which number it is
        self._rows.append(self._row.copy())
        for kind, signal_of, begin, end in self._heard:
            self._now[kind] = signal_of(numbers[begin:end])

    def channels(self) -> dict[str, np.ndarray]:
        names = (channel for kind, *_ in self._writes for channel in TOPICS[kind].channels)
        return dict(zip(names, np.array(self._rows).T, strict=True))


def _player(configuration: Configuration, now: dict[type, Any], heard: Collection[type]) -> _Player:
    made = configuration.create()
    if getattr(made, "row", None) is None:
        return _Player(configuration, made, now)
    return _RowPlayer(configuration, made, now, heard)


def run_offline(
    configurations: Mapping[str, Configuration],
    duration: float,
    progress: Progress = lambda time: None,
    note: Callable[[str, str], None] = lambda role, text: None,
) -> Recording:
    """The recording of all roles from rest to `duration` seconds, both ends included.

    `progress` is told the simulated time now and then, `note` each text that the object of a role has to say. Raises
    ParameterError if the roles do not fit together, and SignalError if one of them gives a number that is not finite.
    """
    check_graph(configurations)
    period = next(iter(configurations.values())).period
    steps = stamps.from_seconds(duration) // period
    now: dict[type, Any] = {}
    heard = {signal for configuration in configurations.values() for signal in configuration.method.reads}
    players = {role: _player(configuration, now, heard) for role, configuration in configurations.items()}
    integrating = [players[role] for role in players if ROLES[role].kind is RoleKind.INTEGRATES]
    answering = [players[role] for role in step_order(ROLES)]
    speaking = [(role, player) for role, player in players.items() if player.speaks]
    time = np.array([stamps.to_seconds(step * period) for step in range(steps + 1)])

    for step, t in enumerate(time.tolist()):
        now[Instant] = Instant(t)
        for player in integrating:
            player.show()
        for player in answering:
            player.answer()
        for role, player in speaking:
            for text in player.notes():
                note(role, text)
        if step < steps:
            for player in integrating:
                player.advance()
        if step % _PROGRESS_STEPS == 0:
            progress(t)
    progress(float(time[-1]))
    channels = {name: column for player in players.values() for name, column in player.channels().items()}
    return Recording(time, channels)
