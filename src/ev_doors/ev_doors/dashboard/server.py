"""The server of the dashboard: one page, and a socket for signals, parameters and requests.

How it works: one thread and one loop. It looks at the graph some times a second, and no look waits;
in between it serves the pages. A new page gets all that is known and the rows that are kept, then
each row as bytes and everything else as JSON.

The graph goes to the pages some times a second, until the run has ended.
"""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from socket import socket
from typing import Any

import tornado.iostream
import tornado.web
import tornado.websocket
from rclpy.context import Context
from rclpy.node import Node
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets

from ev_doors.dashboard.controls import GRAPH_PERIOD, Controls, line
from ev_doors.dashboard.live_frames import LiveFrames, Reported
from ev_msgs_py.contract.roles import MASTER
from ev_stack.recording.outcome import RunFailed
from ev_stack.report.page.writing import filled
from ev_stack.running.node_reports import observing
from ev_stack.scenarios.about import NAMESPACE

ADDRESS = "127.0.0.1"  # no other machine can ask
_KEPT = 1200  # rows that a page gets when it is opened
_LONGEST_REQUEST = 1 << 20  # bytes
# The page is one file with its scripts and styles inside; nothing is loaded from elsewhere.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self';"
    " img-src data:"
)
_NODE = "dashboard"  # in the graph
_PERIOD = 0.05  # s of wall time between two looks
_PATIENCE = 10.0  # s for a graph to be found to which we are to attach


def listening(port: int) -> list[socket]:
    """Sockets that listen at a port of this machine, 0 for any; RunFailed if it is taken."""
    try:
        return bind_sockets(port, ADDRESS)
    except OSError as error:
        raise RunFailed(
            f"--port {port} is refused: {error.strerror}, expected a free one, or 0 for any"
        ) from None


class Pages:
    """All open pages.

    `obey` carries out a request or raises ValueError, `present()` greets a page.
    """

    def __init__(
        self,
        title: str,
        sockets: list[socket],
        obey: Callable[[Mapping[str, Any]], None],
        present: Callable[[], list[dict]],
    ) -> None:
        self.obey, self.present = obey, present
        self.open: set[_Socket] = set()
        self.rows: deque[bytes] = deque(maxlen=_KEPT)
        self.port: int = sockets[0].getsockname()[1]
        # A name of another site that resolves to this machine (DNS rebinding) is not among them.
        hosts = {f"{name}:{self.port}" for name in (ADDRESS, "localhost")}
        text = filled("dashboard.html", title=title)
        self._server = HTTPServer(
            tornado.web.Application(
                [
                    ("/", _Page, {"hosts": hosts, "text": text}),
                    ("/live", _Socket, {"hosts": hosts, "pages": self}),
                ],
                # Else tornado prints a line for each request.
                log_function=lambda handler: None,
                # [s] A page that has gone without closing its socket is noticed by this.
                websocket_ping_interval=10,
                websocket_max_message_size=_LONGEST_REQUEST,
            )
        )
        self._server.add_sockets(sockets)

    @property
    def url(self) -> str:
        """Address of the page for a browser."""
        return f"http://{ADDRESS}:{self.port}/"

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message to all pages."""
        for page in tuple(self.open):
            page.send(message)

    def add(self, row: bytes) -> None:
        """Send a row of numbers to all pages; one that is slow misses some."""
        self.rows.append(row)
        for page in tuple(self.open):
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
    """Refuse a browser that came under another host name.

    A page of another site could send requests under its own name.
    """

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
            self._sent = self._write(row)
        self.pages.open.add(self)

    def on_close(self) -> None:
        self.pages.open.discard(self)

    def on_message(self, message: str | bytes) -> None:
        try:
            request = json.loads(message)
            if not isinstance(request, dict):
                raise ValueError("a request of a page is refused, expected an object")
            self.pages.obey(request)
        # Of the parser of JSON; ValueError is all else that it refuses.
        except RecursionError:
            self.send(line("a request of a page is refused: it is nested too deeply", refused=True))
        except ValueError as error:
            self.send(line(str(error), refused=True))

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message, unless the page has gone."""
        self._write(json.dumps(message))

    def send_row(self, row: bytes) -> None:
        """Send numbers, unless the page has not taken the last ones yet."""
        # Rows that wait for a slow page would pile up in memory: it misses some instead.
        if self._sent is None or self._sent.done():
            self._sent = self._write(row)

    def _write(self, message: str | bytes) -> Any:
        """Send a message; the future ends when it has left, and is None if the page has gone."""
        try:
            return asyncio.ensure_future(
                self._left(self.write_message(message, isinstance(message, bytes)))
            )
        except tornado.websocket.WebSocketClosedError:
            return None

    @staticmethod
    async def _left(sent: Any) -> None:
        with suppress(tornado.websocket.WebSocketClosedError, tornado.iostream.StreamClosedError):
            await sent


async def attached(
    namespace: str | None, domain: int, sockets: list[socket], run: subprocess.Popen | None
) -> str | None:
    """Serve pages until the run has ended, and return the reason in words.

    None if Ctrl-C or SIGTERM came first.

    Without a `namespace` the pages show the graph that has a master of time, and another one after
    it. Without a `run` of our own the graph has ended when its master has left. RunFailed if there
    is none.
    """
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for kind in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(kind, stopped.set)
    # The keys of the default namespace, where security is asked for and none is named.
    with observing(namespace or NAMESPACE, domain, _NODE) as observer:
        dashboard = _Dashboard(observer, sockets, namespace)
        start = next_look = loop.time()
        try:
            print(f"dashboard: {dashboard.pages.url}", flush=True)
            while not stopped.is_set():
                dashboard.look()
                if run is not None and run.poll() is not None:
                    return "the run has ended"
                if run is None and dashboard.master and not dashboard.has_master:
                    return f"{dashboard.master} has left, the run has ended"
                if run is None and not dashboard.master and loop.time() - start > _PATIENCE:
                    anywhere = f"{namespace}/{MASTER}" if namespace else MASTER
                    raise RunFailed(f"no {anywhere} in ROS domain {domain} after {_PATIENCE:g} s")
                # In a fixed pace, but without making up for looks that were missed.
                next_look = max(next_look + _PERIOD, loop.time())
                await asyncio.sleep(next_look - loop.time())
            return None
        finally:
            dashboard.close()
            await asyncio.sleep(0)  # so that the pages get it


class _Graph:
    """Signals from the graph of a namespace, and the requests that it answers."""

    def __init__(
        self, context: Context, namespace: str, tell: Callable[[dict[str, Any]], None]
    ) -> None:
        self.title = {"kind": "title", "text": f"EV Control Stack {namespace}"}
        self._node = Node(
            f"{_NODE}_signals", context=context, namespace=namespace, start_parameter_services=False
        )
        self.namespace, self._tell, self._reported = namespace, tell, set[str]()
        self.reported = Reported(self._node)
        self.controls = Controls(context, namespace, f"{_NODE}_controls", self._tell_pages)
        self.frames = LiveFrames(self._node, self._refuse)

    def _tell_pages(self, message: dict[str, Any]) -> None:
        self.frames.take_car(message)
        self._tell(message)

    def _refuse(self, cause: str, text: str) -> None:
        if cause not in self._reported:
            self._reported.add(cause)
            self.controls.say(text)

    def close(self) -> None:
        """Listen no longer, and let the pages forget its nodes."""
        for name in self.controls.nodes:
            self._tell({"kind": "gone", "node": name})
        self.controls.close()
        self._node.destroy_node()


class _Dashboard:
    """The pages, and the graph that they show: that of a namespace, or the one that runs."""

    def __init__(self, observer: Any, sockets: list[socket], namespace: str | None) -> None:
        self.master = ""  # of the graph that is shown, once it was there
        self._observer, self._next_look = observer, 0.0
        self._columns: list[str] = []
        self._time = 0.0
        self.pages = Pages("EV Control Stack", sockets, self._obey, self._present)
        self._graph: _Graph | None = None
        self._may_change = namespace is None
        if namespace is not None:
            self._show(namespace)

    @property
    def has_master(self) -> bool:
        """Mark of a shown graph that has a master of time."""
        return self._graph is not None and self._graph.controls.has_master

    def look(self) -> None:
        """Take what has come and pass it on."""
        if self._may_change and not self.has_master and time.monotonic() > self._next_look:
            self._next_look = time.monotonic() + GRAPH_PERIOD
            there = {
                space
                for name, space in self._observer.get_node_names_and_namespaces()
                if name == MASTER
            }
            if there and (self._graph is None or self._graph.namespace not in there):
                # Of several graphs always the same one, whatever order discovery gives.
                self._show(min(there))
        if (graph := self._graph) is None:
            return
        for word, about_time in graph.reported.look():
            graph.controls.say(word, refused=not about_time)
        graph.controls.look()
        if graph.controls.has_master:
            self.master = f"{graph.namespace}/{MASTER}"
        if not graph.frames.look():
            return
        # Time that goes back is another run: its rows do not continue those before.
        if graph.frames.columns != self._columns or graph.frames.time < self._time:
            self._columns = graph.frames.columns
            self.pages.forget()
            self.pages.tell(graph.frames.layout())
        self._time = graph.frames.time
        self.pages.add(graph.frames.row())

    def _show(self, namespace: str) -> None:
        if self._graph is not None:
            self._graph.close()
        self._columns = []
        self._graph = _Graph(self._observer.context, namespace, self.pages.tell)
        self.pages.tell(self._graph.title)

    def close(self) -> None:
        """Let the pages go."""
        self.pages.close()

    def _obey(self, request: Mapping[str, Any]) -> None:
        if self._graph is None:
            raise ValueError("no run is there yet: nothing was asked for")
        self._graph.controls.obey(request)

    def _present(self) -> list[dict[str, Any]]:
        if (graph := self._graph) is None:
            return []
        # The title first: a page forgets all when it comes.
        return [graph.title, graph.frames.layout(), *graph.controls.nodes.values()]
