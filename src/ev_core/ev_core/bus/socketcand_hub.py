"""A hub for frames between processes of one machine, by the raw mode of socketcand's protocol over TCP.

For machines without multicast. Text in angle brackets: `open NAME`, `rawmode`, then `send ID LENGTH BYTES` from a
client, and `frame ID SECONDS DATA` to all others with the same name.
"""

from __future__ import annotations

import math
import os
import re
import selectors
import socket
import time
from collections.abc import Callable
from contextlib import suppress

from ev_msgs_py.refusal import quoted

HOST = "127.0.0.1"  # frames never leave this machine
_MOST_CLIENTS = 32
_SETTLES = 0.1  # s behind the last answer in which a client is sent no frame: python-can takes all for the answer
_LONGEST_TEXT = 200  # characters of an unfinished command
_MOST_WAITING = 1 << 20  # bytes for a client that does not take them, some seconds of a full bus; the rest is lost
# Hexadecimal digits and nothing else: int() would also take signs, underscores and the digits of other scripts.
_SEND = re.compile(r"send ([0-7][0-9A-Fa-f]{2}|[01][0-9A-Fa-f]{7}) ([0-8])((?: [0-9A-Fa-f]{1,2})*)")


class _Client:
    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.bus = ""
        self.settled = math.inf  # when frames may come
        self.text = ""
        self.waiting = bytearray()

    @property
    def is_settled(self) -> bool:
        return time.monotonic() >= self.settled


class SocketcandHub:
    """Accepts clients and passes frames on; `port` 0 takes any free one. OSError if the port is taken.

    `warn` is called once for each kind of trouble; a client that sends anything else gets an error and is sent away.
    """

    def __init__(self, port: int, warn: Callable[[str], None] = lambda text: None) -> None:
        self._listener = socket.create_server((HOST, port))
        self._listener.setblocking(False)
        self.port: int = self._listener.getsockname()[1]
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ, None)
        self._clients: set[_Client] = set()
        self._warn, self._said = warn, set[str]()
        self._spare = os.open(os.devnull, os.O_RDONLY)  # by it one is sent away where none is left

    def serve(self, timeout: float) -> None:
        """Deal with what comes within `timeout` [s]."""
        settling = [client for client in self._clients if client.waiting and not client.is_settled]
        for key, events in self._selector.select(min(timeout, _SETTLES / 10) if settling else timeout):
            if key.data is None:
                self._accept()
                continue
            if events & selectors.EVENT_WRITE:
                self._write(key.data)
            if events & selectors.EVENT_READ and key.data in self._clients:
                self._read(key.data)
        for client in settling:
            if client in self._clients and client.is_settled:
                self._write(client)

    def close(self) -> None:
        """Send everybody away."""
        for client in list(self._clients):
            self._drop(client)
        self._selector.close()
        self._listener.close()
        os.close(self._spare)

    def _accept(self) -> None:
        try:
            connection, _ = self._listener.accept()
        except (BlockingIOError, ConnectionAbortedError):  # it has gone already
            return
        except OSError as error:
            self._say_once("accept", f"a client is sent away: {error.strerror}")
            os.close(self._spare)
            with suppress(OSError):
                self._listener.accept()[0].close()
            self._spare = os.open(os.devnull, os.O_RDONLY)
            return
        if len(self._clients) == _MOST_CLIENTS:
            self._say_once("many", f"a client is sent away: there are {_MOST_CLIENTS}, which is the most")
            connection.close()
            return
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = _Client(connection)
        self._clients.add(client)
        self._selector.register(connection, selectors.EVENT_READ, client)
        self._say(client, "< hi >")

    def _read(self, client: _Client) -> None:
        try:
            came = client.connection.recv(65536)
        except BlockingIOError:
            return
        except OSError:
            came = b""
        if not came:
            self._drop(client)
            return
        *commands, client.text = (client.text + came.decode("ascii", errors="replace")).split(">")
        for command in commands:
            if client not in self._clients:
                return
            self._obey(client, command)
        if len(client.text) > _LONGEST_TEXT:
            self._refuse(client, client.text)

    def _obey(self, client: _Client, command: str) -> None:
        begin, _, text = command.partition("<")
        words = "" if begin.strip() else " ".join(text.split())
        if words.startswith("open ") and words.count(" ") == 1:
            client.bus = words.removeprefix("open ")
            self._say(client, "< ok >")
        elif words == "rawmode" and client.bus:
            self._say(client, "< ok >")
            client.settled = time.monotonic() + _SETTLES
        elif client.bus and (frame := _frame(words)):
            for other in [c for c in self._clients if c is not client and c.bus == client.bus and c.settled < math.inf]:
                self._say(other, frame)
        else:
            self._refuse(client, command)

    def _refuse(self, client: _Client, command: str) -> None:
        self._say_once("refused", f"a client is sent away: {quoted(command)} is no command or no frame")
        client.settled = 0.0
        self._say(client, "< error unknown command >")
        self._drop(client)

    def _say_once(self, kind: str, text: str) -> None:
        if kind not in self._said:
            self._said.add(kind)
            self._warn(text)

    def _say(self, client: _Client, text: str) -> None:
        """What a client does not take at once waits for it, so that others do not."""
        if client in self._clients and len(client.waiting) < _MOST_WAITING:
            client.waiting += text.encode()
            # Else it is full, or has yet to settle, and is written to as soon as that is over.
            if len(client.waiting) == len(text) and (client.is_settled or client.settled == math.inf):
                self._write(client)

    def _write(self, client: _Client) -> None:
        try:
            sent = client.connection.send(client.waiting)
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(client)
            return
        del client.waiting[:sent]
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.waiting else 0)
        self._selector.modify(client.connection, events, client)

    def _drop(self, client: _Client) -> None:
        if client in self._clients:
            self._clients.remove(client)
            self._selector.unregister(client.connection)
            with suppress(OSError):
                client.connection.close()


def _frame(words: str) -> str | None:
    """The text for the others: identifier, time, data; None if these words are no frame."""
    found = _SEND.fullmatch(words)
    if found is None:
        return None
    identifier, length, data = found[1].upper(), int(found[2]), found[3].split()
    if len(data) != length:
        return None
    return f"< frame {identifier} {time.time():.6f} {''.join(byte.rjust(2, '0') for byte in data).upper()} >"
