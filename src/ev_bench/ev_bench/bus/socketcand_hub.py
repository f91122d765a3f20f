"""A hub for frames between processes of one machine, by socketcand's raw mode over TCP.

How it works: one asyncio loop has all connections, and runs while `serve` is called. What one
client sends on a bus goes to all others on it. Nothing waits for a client: what it does not take is
kept for it, up to a limit, and then lost.

For machines without multicast. Text in angle brackets: `open NAME`, `rawmode`, then `send ID LENGTH
BYTES` from a client, and `frame ID SECONDS DATA` to all others with the same name.
"""

from __future__ import annotations

import asyncio
import os
import re
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from ev_msgs_py.refusal import quoted

HOST = "127.0.0.1"  # frames never leave this machine
_MOST_CLIENTS = 32
# s behind the last answer in which a client is sent no frame: python-can takes all for the answer
_SETTLES = 0.1
_LONGEST_TEXT = 200  # characters of an unfinished command
# bytes for a client that does not take them, some seconds of a full bus; the rest is lost
_MOST_WAITING = 1 << 20
# Hexadecimal digits and nothing else: int() would also take signs, underscores and the digits of
# other scripts.
_SEND = re.compile(r"send ([0-7][0-9A-Fa-f]{2}|[01][0-9A-Fa-f]{7}) ([0-8])((?: [0-9A-Fa-f]{1,2})*)")


class _Client(asyncio.Protocol):
    """A connection; what its end does not take at once waits for it, so that others do not."""

    def __init__(self, hub: SocketcandHub) -> None:
        self._hub = hub
        self._bus = self._text = ""
        self._takes_frames = False  # whether it has asked for them
        self._early: bytearray | None = bytearray()  # frames that have come before it has settled

    def connection_made(self, transport: Any) -> None:
        """Greet, unless there are too many."""
        self.transport = transport
        if len(self._hub.clients) == _MOST_CLIENTS:
            self._hub.warn_once(
                "many", f"a client is sent away: there are {_MOST_CLIENTS}, which is the most"
            )
            transport.abort()
            return
        self._hub.clients.add(self)
        transport.write(b"< hi >")

    def connection_lost(self, error: Exception | None) -> None:
        """It has gone, or was sent away."""
        self._hub.clients.discard(self)

    def data_received(self, data: bytes) -> None:
        """Obey the commands that are complete."""
        # TCP has no messages: a command may come in pieces, and what is behind the last bracket
        # waits.
        *commands, self._text = (self._text + data.decode("ascii", errors="replace")).split(">")
        for command in commands:
            if self.transport.is_closing():
                return
            self._obey(command)
        if len(self._text) > _LONGEST_TEXT:
            self._refuse(self._text)

    def _obey(self, command: str) -> None:
        begin, _, text = command.partition("<")
        # Text before the bracket belongs to no command, so this is none.
        words = "" if begin.strip() else " ".join(text.split())
        if words.startswith("open ") and words.count(" ") == 1:
            self._bus = words.removeprefix("open ")
            self.transport.write(b"< ok >")
        elif words == "rawmode" and self._bus:
            self.transport.write(b"< ok >")
            self._takes_frames = True
            asyncio.get_running_loop().call_later(_SETTLES, self.settle)
        elif self._bus and (frame := _frame(words)):
            # `open_channel` promises a bus that does not receive its own frames.
            for other in self._hub.clients - {self}:
                other.take(self._bus, frame.encode())
        else:
            self._refuse(command)

    def settle(self) -> None:
        """Start to send frames to this client."""
        early, self._early = self._early, None
        if early and not self.transport.is_closing():
            self.transport.write(early)

    def take(self, bus: str, frame: bytes) -> None:
        """A frame on a bus, which may be another one."""
        if bus == self._bus and self._takes_frames and not self.transport.is_closing():
            put, waiting = self.transport.write, self.transport.get_write_buffer_size()
            if self._early is not None:
                put, waiting = self._early.extend, len(self._early)
            # A client that does not read loses frames, instead of filling the memory of the hub.
            if waiting < _MOST_WAITING:
                put(frame)

    def _refuse(self, command: str) -> None:
        self._hub.warn_once(
            "refused", f"a client is sent away: {quoted(command)} is no command or no frame"
        )
        self.transport.write(b"< error unknown command >")
        self.transport.close()


class SocketcandHub:
    """Hub that accepts clients and passes frames on; `port` 0 takes any free one.

    `warn` is called once for each kind of trouble; a client that sends anything else gets an error
    and is sent away.
    """

    def __init__(self, port: int, warn: Callable[[str], None] = lambda text: None) -> None:
        self._listener = socket.create_server((HOST, port))
        self.port: int = self._listener.getsockname()[1]
        self.clients: set[_Client] = set()
        self._warn, self._warned = warn, set[str]()
        # by it clients are sent away where none is left
        self._spare = os.open(os.devnull, os.O_RDONLY)
        self._loop = asyncio.new_event_loop()
        self._loop.set_exception_handler(self._on_error)
        serving = self._loop.create_server(lambda: _Client(self), sock=self._listener)
        self._server = self._loop.run_until_complete(serving)

    def serve(self, duration: float) -> None:
        """Deal with what comes in the next seconds."""
        self._loop.run_until_complete(asyncio.sleep(duration))

    def close(self) -> None:
        """Send everybody away."""
        self._server.close()
        for client in self.clients:
            client.transport.abort()
        self.serve(0.0)
        self._loop.close()
        os.close(self._spare)

    def warn_once(self, kind: str, text: str) -> None:
        """Warn of the first trouble of its kind."""
        if kind not in self._warned:
            self._warned.add(kind)
            self._warn(text)

    def _on_error(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Report that no descriptor is left for waiting clients.

        Asyncio looks again after a second.
        """
        error = context.get("exception")
        if not isinstance(error, OSError):
            loop.default_exception_handler(context)
            return
        self.warn_once("accept", f"a client is sent away: {error.strerror}")
        # With the spare descriptor clients that wait can be accepted, just to be closed: they need
        # not wait until one of the others leaves.
        os.close(self._spare)
        with suppress(OSError):
            while True:
                self._listener.accept()[0].close()
        self._spare = os.open(os.devnull, os.O_RDONLY)


def _frame(words: str) -> str | None:
    """The text for the others: identifier, time, data; None if these words are no frame."""
    found = _SEND.fullmatch(words)
    # Not the text of a data frame with at most eight bytes.
    if found is None:
        return None
    identifier, length, data = found[1].upper(), int(found[2]), found[3].split()
    if len(data) != length:
        return None
    return (
        f"< frame {identifier} {time.time():.6f}"
        f" {''.join(byte.rjust(2, '0') for byte in data).upper()} >"
    )
