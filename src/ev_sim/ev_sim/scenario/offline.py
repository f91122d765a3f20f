"""The graph without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from ev_msgs_py import stamps
from ev_msgs_py.configuration import Configuration, check_graph
from ev_msgs_py.graph import step_order
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.signals import Instant
from ev_sim.recording.recording import Recording
from ev_sim.scenario.player import Player, SignalPlayer
from ev_sim.scenario.row_player import RowPlayer

Progress = Callable[[float], None]
_PROGRESS_STEPS = 100


def _player(configuration: Configuration, now: dict[type, Any], instants: int, heard: Collection[type]) -> Player:
    made = configuration.create()
    if getattr(made, "row", None) is None:
        return SignalPlayer(configuration, made, now, instants)
    return RowPlayer(configuration, made, now, instants, heard)


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
    players = {role: _player(configuration, now, steps + 1, heard) for role, configuration in configurations.items()}
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
