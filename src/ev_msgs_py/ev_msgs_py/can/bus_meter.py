"""What a channel carries in real time, as one of its ends sees it."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache

from ev_msgs_py.can.wire_time import Header, header, wire_bits

_header = cache(header)


class BusMeter:
    """Counts bits, and times the frames with the identifiers that its end awaits, since it was last cleared.

    The latency of a frame is the time [s] from when operating system, hub or hardware had it until the node took it.
    Bits are those of the wire, stuff bits and the pause counted, whatever carries the frames.
    """

    def __init__(self, awaited: Collection[int]) -> None:
        self._awaited = frozenset(awaited)
        self.clear()

    def clear(self) -> None:
        """Begin anew."""
        self.bits = self.latency = 0.0

    def note(self, identifier: int, data: bytes, latency: float = 0.0) -> None:
        """A frame was sent or received."""
        head: Header = _header(identifier, len(data))
        self.bits += wire_bits(*head, int.from_bytes(data, "little"), len(data))
        if identifier in self._awaited:
            self.latency = max(self.latency, latency)
