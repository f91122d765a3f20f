"""An object of an offline run whose outputs lie in a row of numbers."""

from __future__ import annotations

import math
from collections.abc import Collection
from itertools import accumulate
from typing import Any

import numpy as np

from ev_msgs_py.configuration import Configuration
from ev_msgs_py.topics import TOPICS
from ev_sim.scenario.player import Player


class RowPlayer(Player):
    """Keeps the `row` of its object for a number of instants, and makes only the signals that somebody hears."""

    def __init__(
        self, configuration: Configuration, made: Any, now: dict[type, Any], instants: int, heard: Collection[type]
    ) -> None:
        super().__init__(configuration, made, now)
        self._row = made.row
        self._rows = np.empty((instants, len(made.row)))
        self._shown = 0
        self._topics = [TOPICS[signal] for signal in configuration.method.writes]
        shapes = [topic.codec.shape for topic in self._topics]
        places = accumulate((shape.size for shape in shapes), initial=0)
        numbers = memoryview(made.row)
        readers = [(shape.signal, shape.reader(numbers, place)) for shape, place in zip(shapes, places, strict=False)]
        self._heard = [(signal, read) for signal, read in readers if signal in heard]

    def show(self) -> None:
        row, now = self._row, self._now
        if not math.isfinite(row.dot(row)):
            self._refuse()
        self._rows[self._shown] = row
        self._shown += 1
        for signal, read in self._heard:
            now[signal] = read()

    def _refuse(self) -> None:
        """SignalError that names the number that is not finite, if there is one and not just a large square."""
        for topic, signal in zip(self._topics, self._object.outputs(), strict=True):
            topic.codec.shape.flat(signal)

    def channels(self) -> dict[str, np.ndarray]:
        names = (name for topic in self._topics for name in topic.channels)
        return dict(zip(names, self._rows.T, strict=True))
