"""What an offline run keeps of one signal."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.topics import TOPICS


class Track:
    """The numbers of a signal, a row for each of a known number of instants.

    `keep(signal)` fills the next row; SignalError if a number is not finite. `carried(signal)` is the signal as its
    message would bring it, or None where that is the signal itself.
    """

    def __init__(self, signal: type, instants: int) -> None:
        self._topic = TOPICS[signal]
        codec = self._topic.codec
        self._rows = np.empty((instants, codec.shape.size))
        self.keep = codec.shape.writer(self._rows)
        self.carried = codec.carried if codec.rounds else None

    def channels(self) -> dict[str, np.ndarray]:
        """All that was kept, by channel."""
        return dict(zip(self._topic.channels, self._rows.T, strict=True))
