"""From the graph to the pages, some times a second, until the run has ended."""

from __future__ import annotations

import asyncio
import signal
import subprocess
from typing import Any

from ev_msgs_py.contract.roles import MASTER
from ev_sim.dashboard.controls import Controls
from ev_sim.dashboard.live_frames import LiveFrames
from ev_sim.dashboard.reports import Reported
from ev_sim.dashboard.server import Pages
from ev_sim.recording.outcome import RunFailed
from ev_sim.running.observing import observing

NAME = "dashboard"  # in the graph
_PERIOD = 0.05  # s of wall time between two looks
_PATIENCE = 10.0  # s for a graph to be found to which we are to attach


async def attached(namespace: str, domain: int, port: int, run: subprocess.Popen | None) -> str | None:
    """Serve pages until the run has ended, and say so in words; None if Ctrl-C or SIGTERM came first.

    Without a `run` of our own the graph has ended when its master of time has left. RunFailed if there is none.
    """
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for kind in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(kind, stopped.set)
    with observing(namespace, domain, NAME) as observer:
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
            await asyncio.sleep(0)  # so that the pages hear of it


class _Dashboard:
    """What is heard, what can be asked, and the pages that show it."""

    def __init__(self, observer: Any, port: int) -> None:
        self.was_there = False
        self._reported = Reported(observer)
        self._said: set[str] = set()
        self._columns: list[str] = []
        self._time = 0.0
        namespace = observer.get_namespace()
        self.controls = Controls(observer.context, namespace, f"{NAME}_controls", self._tell)
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
