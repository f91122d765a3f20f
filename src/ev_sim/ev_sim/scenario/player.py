"""The object that plays a role in an offline run, among the signals of the present instant."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import Any

import numpy as np

from ev_msgs_py.configuration import Configuration
from ev_msgs_py.notes import Notes
from ev_sim.scenario.track import Track


class Player(ABC):
    """Plays a role with an object of its method; `now` has the present signals of all roles, by type."""

    def __init__(self, configuration: Configuration, made: Any, now: dict[type, Any]) -> None:
        self._object = made
        self._now = now
        self._heard_of = _inputs(configuration.method.reads)
        self._notes = Notes()
        self._reports = getattr(made, "reports", None)

    @abstractmethod
    def show(self) -> None:
        """Put the outputs of an integrating object among the signals, and keep them.

        SignalError, before anybody goes on with them, if one is not finite.
        """

    @abstractmethod
    def channels(self) -> dict[str, np.ndarray]:
        """All that it has said, by channel."""

    def advance(self) -> None:
        """Integrate with the present signals to the next instant."""
        self._object.advance(*self._heard_of(self._now))

    @property
    def speaks(self) -> bool:
        """Whether the object ever has something to say besides its signals."""
        return self._reports is not None

    def notes(self) -> list[str]:
        """What the object has to say for the first time."""
        return self._notes.new(self._object) if self._reports() else []


class SignalPlayer(Player):
    """Keeps the signals of its object for a number of instants, one by one."""

    def __init__(self, configuration: Configuration, made: Any, now: dict[type, Any], instants: int) -> None:
        super().__init__(configuration, made, now)
        self._tracks = [Track(signal, instants) for signal in configuration.method.writes]
        # Taken apart here, because that is done several times a step.
        self._parts = [
            (kind, track.carried, track.keep)
            for kind, track in zip(configuration.method.writes, self._tracks, strict=True)
        ]

    def show(self) -> None:
        for part, signal in zip(self._parts, self._object.outputs(), strict=True):
            self._say(part, signal)

    def answer(self) -> None:
        """Put the answer to the present signals among them, and keep it; SignalError as above."""
        self._say(self._parts[0], self._object.step(*self._heard_of(self._now)))

    def _say(self, part: tuple[type, Any, Any], signal: Any) -> None:
        kind, carried, keep = part
        if carried:
            signal = carried(signal)
        keep(signal)
        self._now[kind] = signal

    def channels(self) -> dict[str, np.ndarray]:
        return {name: values for track in self._tracks for name, values in track.channels().items()}


def _inputs(reads: tuple[type, ...]) -> Callable[[Mapping[type, Any]], tuple[Any, ...]]:
    """Picks what a method reads out of the present signals, in the order of its arguments."""
    if len(reads) == 1:
        (only,) = reads
        return lambda now: (now[only],)
    return itemgetter(*reads) if reads else lambda now: ()
