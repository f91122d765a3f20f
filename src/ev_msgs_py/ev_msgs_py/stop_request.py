"""Ctrl-C and SIGTERM as a wish that the program looks at when it suits, between two steps."""

from __future__ import annotations

import signal
from types import FrameType


class StopRequest:
    """Remembers that SIGINT or SIGTERM came; a second one raises KeyboardInterrupt wherever the program is.

    rclpy's own handlers shut its context down under a node that is just using it. This one leaves everything intact,
    so that the node can finish what it does and say goodbye. To be made in the main thread.
    """

    def __init__(self) -> None:
        self.received = False
        for kind in (signal.SIGINT, signal.SIGTERM):
            signal.signal(kind, self._on_signal)

    def _on_signal(self, kind: int, frame: FrameType | None) -> None:
        if self.received:
            raise KeyboardInterrupt
        self.received = True
