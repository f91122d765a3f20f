"""Alarm for a time of day that was set back: it ends the waits of this process for messages.

A middleware that was built for a C library that can wait by the time of day only, as the wheels of
PyPI are, adds time-outs to that. A wait of a millisecond then lasts an hour longer if the clock is
set back by an hour just then, and a car in real time would stand still for it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation

_SET_BACK = 1_000_000  # ns: a wait that is longer by less than that does no harm
_PERIOD = 0.02  # s between looks at the clocks


def ahead() -> int:
    """Time by which the time of day is ahead of the monotonic clock [ns]."""
    return time.time_ns() - time.monotonic_ns()


class Alarm:
    """Triggers its `guard`, which every wait of ours includes, when the time of day has been set back.

    It calls `wake` as well, for an executor: even a look without waiting is a wait for no time
    there. It watches in its `with` block.
    """

    def __init__(self, context: Context, wake: Callable[[], object]) -> None:
        self._wake = wake
        handle: Any = context.handle
        with handle:
            self.guard = rclpy_implementation.GuardCondition(handle)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="alarm", daemon=True)

    def __enter__(self) -> Alarm:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        before = ahead()
        while not self._ended.wait(_PERIOD):
            now = ahead()
            if now < before - _SET_BACK:
                self.guard.trigger_guard_condition()
                self._wake()
            before = now
