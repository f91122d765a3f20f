"""What an offline run keeps of one signal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ev_msgs_py.topics import TOPICS


class Track:
    """The numbers of a signal, a row for each of a known number of instants.

    `keep(signal)` fills the next row and gives the signal back as its message would carry it; SignalError if a number
    is not finite.
    """

    def __init__(self, signal: type, instants: int) -> None:
        self.signal = signal
        self._rows = np.empty((instants, TOPICS[signal].codec.shape.size))
        self.keep = _keeper(signal, self._rows)

    def channels(self) -> dict[str, np.ndarray]:
        """All that was kept, by channel."""
        return dict(zip(TOPICS[self.signal].channels, self._rows.T, strict=True))


def _keeper(signal: type, rows: np.ndarray) -> Callable[[Any], Any]:
    # A closure, because this is done for every signal of every step and attributes cost more than the work.
    codec = TOPICS[signal].codec
    carried = codec.carried if codec.rounds else None
    flat, pack, size = codec.shape.flat, codec.shape.packing.pack_into, codec.shape.packing.size
    memory, place = memoryview(rows).cast("B"), 0

    def keep(signal: Any) -> Any:
        nonlocal place
        if carried:
            signal = carried(signal)
        pack(memory, place, *flat(signal))
        place += size
        return signal

    return keep
