"""The newest inputs, held: what realtime integrates with, whenever they come."""

from __future__ import annotations

import time
from collections.abc import Sequence

from ev_core.nodes.master.parameters import MasterParameters
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import WheelTorqueCommand

_COMMAND = frame.PLACES[WheelTorqueCommand]


_DRIVE = slice(_COMMAND.start, _COMMAND.start + 4)


_BRAKE = slice(_COMMAND.start + 4, _COMMAND.stop)


class HeldInputs:
    """Keeps the numbers of the newest message of each kind, its stamp, and when it came."""

    def __init__(self, reads: tuple[type, ...]) -> None:
        self._reads = reads
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._frame = Frame()
        self._stamps: dict[type, int] = {}
        self._command_came = 0.0

    def take(self, kind: type, stamp: int, numbers: Sequence[float], limit: int) -> bool:
        """Keep a message, whose stamp must be above those of its kind before and not above the limit; whether it is."""
        if not self.stamp_of(kind) < stamp <= limit:
            return False
        self._stamps[kind] = stamp
        self._frame.numbers[frame.PLACES[kind]] = frame.numbers_of(numbers)
        if kind is WheelTorqueCommand:
            self.came_now()
        return True

    def came_now(self) -> None:
        """The age of the torque command by the wall clock counts from now on."""
        self._command_came = time.monotonic()

    def stamp_of(self, kind: type) -> int:
        """The stamp of the message of a kind that is held, -1 if there is none."""
        return self._stamps.get(kind, -1)

    @property
    def missing(self) -> tuple[type, ...]:
        """What has not been heard yet."""
        return tuple(kind for kind in self._reads if kind not in self._stamps)

    def share(self, now: int, period: int, p: MasterParameters) -> float:
        """What is left of the held torque command [1] in the step from now on.

        It falls to zero by a ramp. No torque acts any more when the command is `command_timeout` old, so what counts
        is its age at the end of the step, by its stamp or by the wall clock, whichever is more.
        """
        sent = self._stamps[WheelTorqueCommand]
        age = max(stamps.to_seconds(now - sent), time.monotonic() - self._command_came)
        left = p.command_timeout - age - stamps.to_seconds(period)
        if left <= 0.0:
            return 0.0
        return min(left / p.command_ramp, 1.0) if p.command_ramp > 0.0 else 1.0

    def at(self, share: float, brake_torque: float) -> Frame:
        """The inputs of a step; what is missing of the command's torques is made up for by braking."""
        here = Frame()
        here.numbers[:] = self._frame.numbers
        if share < 1.0:
            numbers = here.numbers
            numbers[_DRIVE] = frame.numbers_of([share * torque for torque in numbers[_DRIVE]])
            brake = (1.0 - share) * brake_torque
            numbers[_BRAKE] = frame.numbers_of([share * torque + brake for torque in numbers[_BRAKE]])
        return here
