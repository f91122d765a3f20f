"""The graph without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ev_msgs_py import stamps
from ev_msgs_py.configuration import Configuration, check_graph
from ev_msgs_py.graph import step_order
from ev_msgs_py.notes import Notes
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.shape import Shape
from ev_msgs_py.signals import Instant
from ev_msgs_py.topics import TOPICS
from ev_sim.recording.recording import Recording

Progress = Callable[[float], None]
_PROGRESS_STEPS = 100


class _Player:
    """The object of one role among the signals of the present instant."""

    def __init__(self, configuration: Configuration, now: dict[type, Any]) -> None:
        self._object = configuration.create()
        self._notes = Notes()
        self._reads = configuration.method.reads
        self._codecs = [(signal, TOPICS[signal].codec) for signal in configuration.method.writes]
        self._now = now
        self._rows: list[tuple[type, Shape, np.ndarray]] = []

    def record_into(self, rows: Mapping[type, np.ndarray]) -> None:
        """Tell where the rows of its signals go."""
        self._rows = [(kind, codec.shape, rows[kind]) for kind, codec in self._codecs]

    def record(self, step: int) -> None:
        """Keep its signals; SignalError, before anybody goes on with them, if one is not finite."""
        for kind, shape, rows in self._rows:
            rows[step] = shape.flat(self._now[kind])

    def state(self) -> None:
        """Put the outputs of an integrating object among the signals."""
        for (kind, codec), signal in zip(self._codecs, self._object.outputs(), strict=True):
            self._now[kind] = codec.carried(signal)

    def answer(self) -> None:
        """Put the answer to the present signals among them."""
        kind, codec = self._codecs[0]
        self._now[kind] = codec.carried(self._object.step(*[self._now[kind] for kind in self._reads]))

    def notes(self) -> list[str]:
        """What the object has to say for the first time."""
        return self._notes.new(self._object)

    def advance(self) -> None:
        """Integrate with the present signals to the next instant."""
        self._object.advance(*[self._now[kind] for kind in self._reads])


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
    players = {role: _Player(configuration, now) for role, configuration in configurations.items()}
    integrating = [players[role] for role in players if ROLES[role].kind is RoleKind.INTEGRATES]
    answering = [players[role] for role in step_order(ROLES)]
    written = [TOPICS[signal] for configuration in configurations.values() for signal in configuration.method.writes]
    rows = {topic.signal: np.empty((steps + 1, len(topic.channels))) for topic in written}
    for player in players.values():
        player.record_into(rows)
    time = np.array([stamps.to_seconds(step * period) for step in range(steps + 1)])

    for step in range(steps + 1):
        now[Instant] = Instant(float(time[step]))
        for player in integrating:
            player.state()
            player.record(step)
        for player in answering:
            player.answer()
            player.record(step)
        for role, player in players.items():
            for text in player.notes():
                note(role, text)
        if step < steps:
            for player in integrating:
                player.advance()
        if step % _PROGRESS_STEPS == 0:
            progress(float(time[step]))
    progress(float(time[-1]))
    channels = {
        channel: rows[topic.signal][:, i] for topic in written for i, channel in enumerate(topic.channels)
    }
    return Recording(time, channels)
