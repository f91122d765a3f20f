"""The channels of a bus as a node uses them: classic data frames in and out, metered and logged.

How it works: a `Channel` has a bus of python-can. It sends and receives without waiting, takes
classic data frames alone and counts the others, and notes each frame in log and meter. `Channels`
are those of both circuits, all of them open or none.
"""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from pathlib import Path

import can

from ev_bench.bus.opening import open_channel
from ev_bench.bus.parameters import LOOPBACK, BusInterface
from ev_msgs_py.can.frame_length import Frame, Header, header, wire_bits
from ev_msgs_py.refusal import quoted

SUFFIXES = (".log", ".blf", ".mf4")
_LONGEST = 8  # bytes of a classic frame
# s: a reader too slow for its bus drops older frames, and so keeps up
_OLDEST = 0.1
# frames taken from a channel at one go: a bus that never falls silent shall not hold a node up
_MOST = 500


def bus_log(file: str) -> can.Listener:
    """Log of frames: each call writes one to a new file, until `stop`.

    ValueError, in one line, if that cannot be or a file is there.
    """
    path = Path(file)
    if path.suffix not in SUFFIXES:
        raise ValueError(
            f"parameter log: {quoted(file)} is refused, expected files ending with"
            f" {', '.join(SUFFIXES)}"
        )
    if os.path.lexists(path):
        raise ValueError(
            f"parameter log: {quoted(file)} is refused, expected a file that is not there yet"
        )
    try:
        # python-can chooses the writer by the suffix; that of .mf4 is an extra.
        return can.Logger(path)
    except (NotImplementedError, ImportError):
        raise ValueError(
            f"parameter log: {quoted(file)} needs the Python package asammdf, which is missing"
        ) from None
    except OSError as error:
        raise ValueError(f"parameter log: {quoted(file)}: {error.strerror or error}") from None


_header = cache(header)


class BusMeter:
    """Meter of a channel since it was last cleared: bits, and times of the awaited frames.

    The latency of a frame is the time [s] from when operating system, hub or hardware had it until
    the node took it. Bits are those of the wire, stuff bits and the pause counted, whatever carries
    the frames.
    """

    def __init__(self, awaited: Collection[int]) -> None:
        self._awaited = frozenset(awaited)
        self.clear()

    def clear(self) -> None:
        """Start to measure again."""
        self.bits = self.latency = 0.0

    def note(self, identifier: int, data: bytes, latency: float = 0.0) -> None:
        """A frame was sent or received."""
        head: Header = _header(identifier, len(data))
        self.bits += wire_bits(*head, int.from_bytes(data, "little"), len(data))
        if identifier in self._awaited:
            self.latency = max(self.latency, latency)


class Channel:
    """Channel that sends and receives without waiting.

    Messages that are no such frame, or that cannot be sent, are counted.
    """

    def __init__(
        self,
        interface: str,
        name: str,
        log: can.Listener | None = None,
        meter: BusMeter | None = None,
        address: str = LOOPBACK,
    ) -> None:
        self.name = name
        self._bus = open_channel(interface, name, address)
        # it receives its own frames, by the clock of this machine
        self._is_multicast = interface == "udp_multicast"
        self._log, self._meter = log, meter
        self._emptied = time.monotonic()  # what comes out later is younger than this
        self.sent = self.received = self.refused = self.unsent = self.late = 0
        self.trouble = ""  # the newest reason why a frame could not be sent or read

    def send(self, frame: Frame) -> None:
        """Put a frame on the bus."""
        message = can.Message(
            timestamp=time.time(),
            arbitration_id=frame.identifier,
            data=frame.data,
            is_extended_id=False,
            is_rx=False,
            channel=self.name,
        )
        try:
            self._bus.send(message)
        except (can.CanError, OSError) as error:
            self.unsent += 1
            self.trouble = f"{self.name}: not sent: {error}"
            return
        self.sent += 1
        if not self._is_multicast:
            self._note(message, 0.0)

    def receive(self) -> Frame | None:
        """The next frame that has come; None if there is none."""
        while True:
            try:
                message = self._bus.recv(timeout=0.0)
            # whatever unpacking a stranger's datagram raises, python-can lets through
            except Exception as error:
                self.refused += 1
                self.trouble = f"{self.name}: not read: {error}"
                return None
            if message is None:
                self._emptied = time.monotonic()
                return None
            age = self._age(message)
            # Late frames are left out one after the other, until the reader has caught up.
            if self._is_multicast and age > _OLDEST:
                self.late += 1
                self.trouble = (
                    f"{self.name}: frames that waited for more than {_OLDEST:g} s were left out"
                )
                continue
            if _is_classic(message):
                self.received += 1
                message.channel = self.name
                self._note(message, age)
                return Frame(message.arbitration_id, bytes(message.data))
            self.refused += 1

    def _age(self, message: can.Message) -> float:
        """Seconds since the frame came to this machine, or to the hub.

        It is stamped by the time of day, which may be set in between; of multicast there is a bound
        that does not know it: no frame has waited for longer than since nothing was waiting.
        """
        by_time_of_day = time.time() - message.timestamp
        return (
            min(by_time_of_day, time.monotonic() - self._emptied)
            if self._is_multicast
            else by_time_of_day
        )

    def _note(self, message: can.Message, age: float) -> None:
        if self._log:
            self._log(message)
        if self._meter:
            self._meter.note(message.arbitration_id, bytes(message.data), age)

    def fileno(self) -> int:
        """Descriptor for `select`, of udp_multicast and socketcan.

        Raises NotImplementedError for other interfaces.
        """
        return self._bus.fileno()

    def close(self) -> None:
        """Leave the bus."""
        self._bus.shutdown()


def _is_classic(message: can.Message) -> bool:
    special = (
        message.is_extended_id or message.is_remote_frame or message.is_error_frame or message.is_fd
    )
    return not special and message.arbitration_id < 1 << 11 and len(message.data) <= _LONGEST


class Channels:
    """Open the channels of the parameters.

    Raises BusError or ValueError, in one line, with nothing left open.
    """

    def __init__(
        self, p: BusInterface, log: str = "", meters: Mapping[str, BusMeter] | None = None
    ) -> None:
        self._channels: dict[str, Channel] = {}
        self._log = bus_log(log) if log else None
        try:
            for circuit, name in p.channels().items():
                self._channels[circuit] = Channel(
                    p.interface, name, self._log, (meters or {}).get(circuit), p.address
                )
        except BaseException:
            self.close()
            # It is empty, and would be in the way at the next try.
            if log:
                Path(log).unlink(missing_ok=True)
            raise

    def send(self, circuit: str, frame: Frame) -> None:
        """Put a frame on the channel of a circuit."""
        self._channels[circuit].send(frame)

    def received(self) -> Iterator[tuple[str, Frame]]:
        """Frames that have arrived, each with its circuit."""
        for circuit, channel in self._channels.items():
            for _ in range(_MOST):
                frame = channel.receive()
                if frame is None:
                    break
                yield circuit, frame

    def troubles(self) -> list[str]:
        """Troubles since the last look."""
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
            self._log.stop()
            self._log = None
