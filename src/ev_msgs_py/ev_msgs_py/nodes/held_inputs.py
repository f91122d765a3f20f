"""The newest inputs, held: what realtime integrates with, whenever they come."""

from __future__ import annotations

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.wire.message_format import format_of, stamp_of


class HeldInputs:
    """Keeps the numbers of the newest message of each kind, and its stamp."""

    def __init__(self, reads: tuple[type, ...]) -> None:
        self._needed = {kind for kind in reads if kind is not WheelTorqueCommand}
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._frame = Frame()
        self._stamps: dict[type, int] = {}

    def take(self, topic: Topic, message: bytes) -> bool:
        """Keep a message in our own layout; whether it is the first of its kind."""
        first = topic.signal not in self._stamps
        self._stamps[topic.signal] = stamp_of(message)
        format_of(topic.signal).unpack(message, self._frame)
        return first

    @property
    def complete(self) -> bool:
        """Whether everything but the torque command, which may be zero, has been heard once."""
        return self._needed <= self._stamps.keys()

    def at(self, now: int, age_limit: int) -> Frame:
        """The inputs of a step; a torque command older than the limit, both in nanoseconds, is zero torque."""
        here = Frame()
        here.raw[:] = self._frame.raw
        sent = self._stamps.get(WheelTorqueCommand)
        if sent is None or now - sent > age_limit:
            place = frame.PLACES[WheelTorqueCommand]
            here.numbers[place] = frame.numbers_of([0.0] * (place.stop - place.start))
        return here
