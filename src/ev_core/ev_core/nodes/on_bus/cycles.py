"""A CAN bus in real time as nodes live with it: frames as they come, and a cycle every millisecond."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

from ev_core.bus.channel import Frame
from ev_core.bus.channels import Channels
from ev_msgs_py.can.frames import TICK


class Ticks:
    """Begins to count when it is made; the clock is monotonic."""

    def __init__(self) -> None:
        self._start, self._counted = time.monotonic(), 0

    def passed(self) -> int:
        """Ticks since the last call; many, if the process was held up."""
        passed = int((time.monotonic() - self._start) / TICK) - self._counted
        self._counted += passed
        return passed

    def until_next(self) -> float:
        """Seconds until the next one."""
        return max(self._start + (self._counted + 1) * TICK - time.monotonic(), 0.0)


_MOST_SAID = 10  # troubles that are told


class SpeaksInCycles(Protocol):
    """Says what a frame and a cycle mean."""

    def take(self, circuit: str, frame: Frame) -> None:
        """A frame has come on the channel of a circuit."""

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Some ticks have passed; circuit and frame of all that is to be sent."""


class BusCycles:
    """Polls open channels for somebody, until it is closed."""

    def __init__(self, channels: Channels, speaker: SpeaksInCycles, warn: Callable[[str], None]) -> None:
        self.channels: Channels | None = channels
        self._speaker, self._warn = speaker, warn
        self._said: set[str] = set()
        self._ticks = Ticks()

    def poll(self) -> bool:
        """Take all frames, and make a cycle if one is due; False if there was nothing to do."""
        if self.channels is None:
            return False
        ticks, progressed = self._ticks.passed(), False
        if ticks > 1:  # it was held up: what waits on the bus came late, and shall not count as if it had not
            self._make(self.channels, ticks)
        for circuit, frame in self.channels.received():
            self._speaker.take(circuit, frame)
            progressed = True
        if ticks == 1:
            self._make(self.channels, ticks)
        return progressed

    def _make(self, channels: Channels, ticks: int) -> None:
        for circuit, frame in self._speaker.cycle(ticks):
            channels.send(circuit, frame)

    def until_next(self) -> float:
        """Seconds until the next cycle."""
        return self._ticks.until_next()

    def tell_troubles(self) -> None:
        """Say once what goes wrong on the bus."""
        for trouble in self.channels.troubles() if self.channels else ():
            if trouble not in self._said and len(self._said) < _MOST_SAID:
                self._said.add(trouble)
                self._warn(trouble)

    def close(self) -> None:
        """Leave the bus."""
        if self.channels is not None:
            self.channels.close()
            self.channels = None


class WithBus:
    """What a node that has a bus does the same whatever else it is; how it is run, see `spinning`."""

    _bus: BusCycles | None = None

    def wake_up_within(self) -> float:
        """Seconds until the next cycle."""
        return self._bus.until_next() if self._bus else 0.0

    def idle(self) -> None:
        """Say once what goes wrong on the bus."""
        if self._bus is not None:
            self._bus.tell_troubles()

    def close(self) -> None:
        """Leave the bus."""
        if self._bus is not None:
            self._bus.close()
