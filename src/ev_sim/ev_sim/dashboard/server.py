"""The server of the dashboard: one page, and a socket on which signals, parameters and wishes go to and fro.

The graph goes to the pages some times a second, until the run has ended.
"""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

import tornado.web
import tornado.websocket
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets

from ev_msgs_py.contract.roles import MASTER
from ev_sim.dashboard.controls import Controls, line
from ev_sim.dashboard.live_frames import LiveFrames, Reported
from ev_sim.recording.outcome import RunFailed
from ev_sim.report.page.writing import filled
from ev_sim.running.node_reports import observing

ADDRESS = "127.0.0.1"  # no other machine can ask
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
                [("/", _Page, {"hosts": hosts, "text": text}), ("/live", _Socket, {"hosts": hosts, "pages": self})],
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


_NODE = "dashboard"  # in the graph
_PERIOD = 0.05  # s of wall time between two looks
_PATIENCE = 10.0  # s for a graph to be found to which we are to attach


async def attached(namespace: str, domain: int, port: int, run: subprocess.Popen | None) -> str | None:
    """Serve pages until the run has ended, and return the reason in words; None if Ctrl-C or SIGTERM came first.

    Without a `run` of our own the graph has ended when its master of time has left. RunFailed if there is none.
    """
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for kind in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(kind, stopped.set)
    with observing(namespace, domain, _NODE) as observer:
        dashboard = _Dashboard(observer, port)
        start = next_look = loop.time()
        try:
            print(f"dashboard: {dashboard.pages.url}", flush=True)
            while not stopped.is_set():
                dashboard.look()
                if run is not None and run.poll() is not None:
                    return "the run has ended"
                if run is None and dashboard.was_there and not dashboard.controls.has_master:
                    return f"{namespace}/{MASTER} has left, the run has ended"
                if run is None and not dashboard.was_there and loop.time() - start > _PATIENCE:
                    raise RunFailed(f"no {namespace}/{MASTER} in ROS domain {domain} after {_PATIENCE:g} s")
                next_look = max(next_look + _PERIOD, loop.time())
                await asyncio.sleep(next_look - loop.time())
            return None
        finally:
            dashboard.close()
            await asyncio.sleep(0)  # so that the pages get it


class _Dashboard:
    """What comes from the graph, what can be asked, and the pages that show it."""

    def __init__(self, observer: Any, port: int) -> None:
        self.was_there = False
        self._reported = Reported(observer)
        self._said: set[str] = set()
        self._columns: list[str] = []
        self._time = 0.0
        namespace = observer.get_namespace()
        self.controls = Controls(observer.context, namespace, f"{_NODE}_controls", self._tell)
        self.frames = LiveFrames(observer, self._refuse)
        self.pages = Pages(f"EV Control Stack {namespace}", port, self.controls.obey, self._present)

    def look(self) -> None:
        """Take what has come and pass it on."""
        for word, about_time in self._reported.look():
            self.controls.say(word, refused=not about_time)
        self.controls.look()
        self.was_there |= self.controls.has_master
        if not self.frames.look():
            return
        if self.frames.columns != self._columns or self.frames.time < self._time:
            self._columns = self.frames.columns
            self.pages.forget()
            self.pages.tell(self.frames.layout())
        self._time = self.frames.time
        self.pages.add(self.frames.row())

    def close(self) -> None:
        """Let the pages go."""
        self.pages.close()

    def _present(self) -> list[dict[str, Any]]:
        return [self.frames.layout(), *self.controls.nodes.values()]

    def _tell(self, message: dict[str, Any]) -> None:
        self.frames.take_car(message)
        self.pages.tell(message)

    def _refuse(self, cause: str, text: str) -> None:
        if cause not in self._said:
            self._said.add(cause)
            self.controls.say(text)
