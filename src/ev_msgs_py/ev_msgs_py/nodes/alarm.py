"""Ends waits of the middleware that would otherwise last for as long as the time of day was set back.

Where it was built for a C library that can wait by the time of day only, as the wheels of PyPI are, it adds time-outs
to that: a wait of a millisecond lasts an hour longer if the clock is set back by an hour just then.
"""

from __future__ import annotations

import threading
import time
from types import TracebackType
from typing import Any

from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation

_PERIOD = 0.02  # s between looks at the clocks
_SET_BACK = 1_000_000  # ns: waits that last longer by less than that are nobody's trouble


class Alarm:
    """When the time of day has been set back it triggers its `guard`, which every wait of ours includes.

    The executor is woken up, too: even to look without waiting it waits for no time. It watches in its `with` block.
    """

    def __init__(self, context: Context, executor: Executor) -> None:
        self._executor = executor
        handle: Any = context.handle
        with handle:
            self.guard = rclpy_implementation.GuardCondition(handle)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, args=(_ahead(),), name="alarm", daemon=True)

    def __enter__(self) -> Alarm:
        self._thread.start()
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self, before: int) -> None:
        while not self._ended.wait(_PERIOD):
            ahead = _ahead()
            if ahead < before - _SET_BACK:
                self.guard.trigger_guard_condition()
                self._executor.wake()
            before = ahead


def _ahead() -> int:
    """How far the time of day is ahead of the monotonic clock [ns]."""
    return time.time_ns() - time.monotonic_ns()
