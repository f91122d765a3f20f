"""The newest inputs, held: what realtime integrates with, whenever they come."""

from __future__ import annotations

from collections.abc import Sequence

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import WheelTorqueCommand


class HeldInputs:
    """Keeps the numbers of the newest message of each kind, and its stamp."""

    def __init__(self, reads: tuple[type, ...]) -> None:
        self._needed = {kind for kind in reads if kind is not WheelTorqueCommand}
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._frame = Frame()
        self._stamps: dict[type, int] = {}

    def take(self, kind: type, stamp: int, numbers: Sequence[float]) -> bool:
        """Keep a message; whether it is the first of its kind."""
        first = kind not in self._stamps
        self._stamps[kind] = stamp
        self._frame.numbers[frame.PLACES[kind]] = frame.numbers_of(numbers)
        return first

    @property
    def complete(self) -> bool:
        """Whether everything but the torque command, which may be zero, has been heard once."""
        return self._needed <= self._stamps.keys()

    def at(self, now: int, age_limit: int) -> Frame:
        """The inputs of a step; a torque command older than the limit, both in nanoseconds, is zero torque."""
        here = Frame()
        here.numbers[:] = self._frame.numbers
        sent = self._stamps.get(WheelTorqueCommand)
        if sent is None or now - sent > age_limit:
            place = frame.PLACES[WheelTorqueCommand]
            here.numbers[place] = frame.numbers_of([0.0] * (place.stop - place.start))
        return here
