"""The live page of a run that is driven here and not over DDS: the same server, messages and rows, no node."""

from __future__ import annotations

import asyncio
import threading
import time
from array import array
from collections.abc import Callable
from typing import Any

from ev_doors.dashboard.controls import node_message
from ev_doors.dashboard.live_frames import layout_message
from ev_doors.dashboard.server import Pages, listening
from ev_msgs_py.contract.roles import MASTER
from ev_nodes.stepping.ros_parameters import descriptor
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_stack.views.car import view_channels


class FedPage:
    """A server in a thread; `requests` are what its pages ask for."""

    def __init__(self) -> None:
        self.requests: list[dict[str, Any]] = []
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever)
        self._thread.start()
        self.pages: Pages = self._in_loop(
            lambda: Pages("a page", listening(0), self.requests.append, list)
        )

    def _in_loop(self, call: Callable[[], Any]) -> Any:
        async def called() -> Any:
            return call()

        return asyncio.run_coroutine_threadsafe(called(), self._loop).result()

    def begin(self, run: Run, recording: Recording, title_text: str) -> None:
        """Another graph under a title, with the first half of what it drives."""
        messages = [
            node_message(
                name, [descriptor(entry) for entry in each.entries()], each.values().values()
            )
            for name, each in run.configurations.items()
        ]
        car = run.configurations[MASTER].common.vehicle
        channels = {**recording.channels, **view_channels(recording, car)}
        numbers = zip(recording.time, *channels.values(), strict=True)
        self._rows = [array("d", row).tobytes() for row in numbers]
        title = {"kind": "title", "text": title_text}
        for message in (title, *messages, layout_message([*channels], car)):
            self._in_loop(lambda message=message: self.pages.tell(message))
        self._send(self._rows[: len(self._rows) // 2])

    def end(self) -> None:
        """The other half, up to the last instant."""
        self._send(self._rows[len(self._rows) // 2 :])

    def _send(self, rows: list[bytes]) -> None:
        def send() -> None:
            for row in rows:
                for page in self.pages.open:
                    # a page that is slow would miss some, as it may
                    page.write_message(row, binary=True)

        self._in_loop(send)

    def tell(self, message: dict[str, Any]) -> None:
        """A message to all pages."""
        self._in_loop(lambda: self.pages.tell(message))

    def wait_for_request(self, request: dict[str, Any]) -> None:
        """Return when a page has asked for this; the time limit of the test ends what never does."""
        while request not in self.requests:
            self._in_loop(lambda: None)
            time.sleep(0.01)

    def close(self) -> None:
        """The server ends, and its thread."""
        self._in_loop(self.pages.close)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()
