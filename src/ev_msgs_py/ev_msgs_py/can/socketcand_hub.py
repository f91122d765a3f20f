"""A hub for frames between processes of one machine, by the raw mode of socketcand's protocol over TCP.

For machines without multicast. Text in angle brackets: `open NAME`, `rawmode`, then `send ID LENGTH BYTES` from a
client, and `frame ID SECONDS DATA` to all others with the same name.
"""

from __future__ import annotations

import selectors
import socket
import time
from contextlib import suppress

HOST = "127.0.0.1"  # frames never leave this machine
_LONGEST_TEXT = 200  # characters of an unfinished command
_MOST_WAITING = 1 << 20  # bytes for a client that does not take them, some seconds of a full bus; the rest is lost


class _Client:
    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.bus = ""
        self.text = ""
        self.waiting = b""


class SocketcandHub:
    """Accepts clients and passes frames on; `port` 0 takes any free one. OSError if the port is taken."""

    def __init__(self, port: int) -> None:
        self._listener = socket.create_server((HOST, port))
        self._listener.setblocking(False)
        self.port: int = self._listener.getsockname()[1]
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ, None)
        self._clients: list[_Client] = []

    def serve(self, timeout: float) -> None:
        """Deal with what comes within `timeout` [s]."""
        for key, events in self._selector.select(timeout):
            if key.data is None:
                self._accept()
                continue
            if events & selectors.EVENT_WRITE:
                self._write(key.data)
            if events & selectors.EVENT_READ and key.data in self._clients:
                self._read(key.data)

    def close(self) -> None:
        """Send everybody away."""
        for client in list(self._clients):
            self._drop(client)
        self._selector.close()
        self._listener.close()

    def _accept(self) -> None:
        connection, _ = self._listener.accept()
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = _Client(connection)
        self._clients.append(client)
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
        client.text += came.decode("ascii", errors="replace")
        while ">" in client.text and client in self._clients:
            command, _, client.text = client.text.partition(">")
            self._obey(client, command.replace("<", " ").split())
        if len(client.text) > _LONGEST_TEXT:
            self._drop(client)

    def _obey(self, client: _Client, words: list[str]) -> None:
        if words[:1] == ["open"] and len(words) == 2:
            client.bus = words[1]
            self._say(client, "< ok >")
        elif words == ["rawmode"] and client.bus:
            self._say(client, "< ok >")
        elif words[:1] == ["send"] and client.bus and (frame := _frame(words[1:])):
            for other in [c for c in self._clients if c is not client and c.bus == client.bus]:
                self._say(other, frame)
        else:
            self._say(client, "< error unknown command >")

    def _say(self, client: _Client, text: str) -> None:
        """What a client does not take at once waits for it, so that others do not."""
        if client in self._clients and len(client.waiting) < _MOST_WAITING:
            client.waiting += text.encode()
            self._write(client)

    def _write(self, client: _Client) -> None:
        try:
            sent = client.connection.send(client.waiting)
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(client)
            return
        client.waiting = client.waiting[sent:]
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.waiting else 0)
        self._selector.modify(client.connection, events, client)

    def _drop(self, client: _Client) -> None:
        if client in self._clients:
            self._clients.remove(client)
            self._selector.unregister(client.connection)
            with suppress(OSError):
                client.connection.close()


def _frame(words: list[str]) -> str | None:
    """The text for the others: identifier, time, data; None if these words are no frame."""
    try:
        identifier, length, data = int(words[0], 16), int(words[1], 16), bytes(int(word, 16) for word in words[2:])
    except (ValueError, IndexError):
        return None
    if len(data) != length or length > 8 or len(words[0]) not in (3, 8):
        return None
    digits = len(words[0])
    return f"< frame {identifier:0{digits}X} {time.time():.6f} {data.hex().upper()} >"
