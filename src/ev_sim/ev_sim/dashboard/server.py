"""The server of the dashboard: one page, and a socket on which signals, parameters and wishes go to and fro."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

import tornado.web
import tornado.websocket
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets

from ev_sim.dashboard.controls import line
from ev_sim.recording.outcome import RunFailed
from ev_sim.report.page.writing import filled

ADDRESS = "127.0.0.1"  # nobody else's machine can ask
_KEPT = 1200  # rows that a page gets when it is opened
_LONGEST_WISH = 1 << 20  # bytes
_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:"


class Pages:
    """All open pages; `obey` does what one of them asks for, ValueError refuses it; `present()` is what a new one gets.

    RunFailed if the port, 0 for any, is taken.
    """

    def __init__(
        self, title: str, port: int, obey: Callable[[Mapping[str, Any]], None], present: Callable[[], list[dict]]
    ) -> None:
        self.obey, self.present = obey, present
        self.open: set[_Socket] = set()
        self.rows: deque[bytes] = deque(maxlen=_KEPT)
        try:
            sockets = bind_sockets(port, ADDRESS)
        except (OSError, OverflowError) as error:
            raise RunFailed(f"--port {port} is refused: {getattr(error, 'strerror', None) or error}") from None
        self.port: int = sockets[0].getsockname()[1]
        hosts = {f"{name}:{self.port}" for name in (ADDRESS, "localhost")}
        text = filled("dashboard.html", title=title)
        self._server = HTTPServer(
            tornado.web.Application(
                [
                    ("/", _Page, {"hosts": hosts, "text": text}),
                    ("/live", _Socket, {"hosts": hosts, "pages": self}),
                ],
                log_function=lambda handler: None,
                websocket_ping_interval=10,
                websocket_max_message_size=_LONGEST_WISH,
            )
        )
        self._server.add_sockets(sockets)

    @property
    def url(self) -> str:
        """Where a browser finds the page."""
        return f"http://{ADDRESS}:{self.port}/"

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message to all pages."""
        for page in self.open:
            page.send(message)

    def add(self, row: bytes) -> None:
        """Send a row of numbers to all pages; one that is slow misses some."""
        self.rows.append(row)
        for page in self.open:
            page.send_row(row)

    def forget(self) -> None:
        """Other columns or another run: the rows so far do not go with those that come."""
        self.rows.clear()

    def close(self) -> None:
        """Take no more pages."""
        self._server.stop()
        for page in list(self.open):
            page.close()


class _Local(tornado.web.RequestHandler):
    """Refuses a browser that was led here under another name: a page of somebody else's could ask in its own."""

    def initialize(self, hosts: set[str], **others: Any) -> None:
        self.hosts = hosts
        for name, value in others.items():
            setattr(self, name, value)

    def prepare(self) -> None:
        if self.request.host not in self.hosts:
            raise tornado.web.HTTPError(403)


class _Page(_Local):
    text: str

    def get(self) -> None:
        self.set_header("Content-Security-Policy", _POLICY)
        self.set_header("Cache-Control", "no-store")
        self.write(self.text)


class _Socket(_Local, tornado.websocket.WebSocketHandler):
    pages: Pages
    _sent: Any = None  # the last row, until it has left

    def open(self, *args: str, **kwargs: str) -> None:
        for message in self.pages.present():
            self.send(message)
        for row in self.pages.rows:
            self._sent = self.write_message(row, binary=True)
        self.pages.open.add(self)

    def on_close(self) -> None:
        self.pages.open.discard(self)

    def on_message(self, message: str | bytes) -> None:
        try:
            wish = json.loads(message)
            if not isinstance(wish, dict):
                raise ValueError("a wish of a page is refused, allowed is an object")
            self.pages.obey(wish)
        except RecursionError:
            self.send(line("a wish of a page is refused: it is nested too deeply", refused=True))
        except ValueError as error:
            self.send(line(str(error), refused=True))

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message, unless the page has just gone."""
        if self.ws_connection is not None:
            self.write_message(json.dumps(message))

    def send_row(self, row: bytes) -> None:
        """Send numbers, unless the page has not taken the last ones yet."""
        if self.ws_connection is not None and (self._sent is None or self._sent.done()):
            self._sent = self.write_message(row, binary=True)
