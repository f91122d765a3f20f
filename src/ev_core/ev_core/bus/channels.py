"""The channels of both circuits, and the log of what they carry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ev_core.bus.channel import BusLog, BusMeter, Channel, Frame
from ev_core.bus.parameters import BusInterface

_MOST = 500  # frames taken from a channel at one go: a bus that never falls silent shall not hold a node up


class Channels:
    """Opens what the parameters say; BusError or ValueError in one line, and nothing stays open, if it cannot."""

    def __init__(self, p: BusInterface, log: str = "", meters: Mapping[str, BusMeter] | None = None) -> None:
        self._channels: dict[str, Channel] = {}
        self._log = BusLog(log) if log else None
        try:
            for circuit, name in p.channels().items():
                self._channels[circuit] = Channel(p.interface, name, self._log, (meters or {}).get(circuit), p.address)
        except BaseException:
            self.close()
            raise

    def __getitem__(self, circuit: str) -> Channel:
        return self._channels[circuit]

    def send(self, circuit: str, frame: Frame) -> None:
        """Put a frame on the channel of a circuit."""
        self._channels[circuit].send(frame)

    def received(self) -> Iterator[tuple[str, Frame]]:
        """What has come, with its circuit."""
        for circuit, channel in self._channels.items():
            for _ in range(_MOST):
                frame = channel.receive()
                if frame is None:
                    break
                yield circuit, frame

    def troubles(self) -> list[str]:
        """What has gone wrong since the last look."""
        found = [channel.trouble for channel in self._channels.values() if channel.trouble]
        for channel in self._channels.values():
            channel.trouble = ""
        return found

    def close(self) -> None:
        """Leave the bus and end the log."""
        for channel in self._channels.values():
            channel.close()
        self._channels.clear()
        if self._log is not None:
            self._log.close()
            self._log = None
