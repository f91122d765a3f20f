"""Time of day: a date that the middleware cannot send, and an alarm for a clock that was set back.

How it works: the middleware's waits can last for as long as the time of day was set back. Where it
was built for a C library that can wait by the time of day only, as the wheels of PyPI are, it adds
time-outs to that: a wait of a millisecond lasts an hour longer if the clock is set back by an hour
just then. The alarm ends our own waits by a guard condition. The middleware's thread, which
announces a process to others and repeats lost messages, restarts its wait when a timer is made, as
for a publisher. So the alarm makes a publisher.

With a publisher a process also announces its parts again. The middleware orders arrivals of
different senders by the time of day, and may lose a message where that was set back: so the alarm
makes several publishers, one after the other.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import NotInitializedException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier

_LAST = 2**31 - 1  # s since 1970
_SET_BACK = 1_000_000  # ns: a wait that is longer by less than that does no harm
_PERIOD = 0.02  # s between looks at the clocks
_AGAIN = (0.0, 0.5, 2.0)  # s after the time of day was set back, when a publisher is made


def too_late() -> str | None:
    """One line if the middleware can send nothing at the time of day that it is: Fast DDS stamps it with 32 bits."""
    now = time.time()
    if now <= _LAST or not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return None
    here, last = (
        time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(instant)) for instant in (now, _LAST)
    )
    return f"the time of day: {here} UTC is past what Fast DDS can send, expected up to {last}, or another middleware"


def refuse_late_time_of_day() -> None:
    """RuntimeError where the middleware could send nothing."""
    trouble = too_late()
    if trouble is not None:
        raise RuntimeError(trouble)


def ahead() -> int:
    """Time by which the time of day is ahead of the monotonic clock [ns]."""
    return time.time_ns() - time.monotonic_ns()


class SetBack:
    """Detects between two looks that the time of day was set back.

    `before` is what `ahead` gave first.
    """

    def __init__(self, before: int) -> None:
        self._before = before

    def is_seen(self) -> bool:
        """Return whether it was set back since the last look."""
        before, self._before = self._before, ahead()
        return self._before < before - _SET_BACK


class Alarm:
    """Triggers its `guard`, which every wait of ours includes, when the time of day has been set back.

    It calls `wake` as well, for an executor: even a look without waiting is a wait for no time
    there. It watches in its `with` block, within the life of the node.
    """

    def __init__(self, node: Node, wake: Callable[[], object] = lambda: None) -> None:
        self._node, self._wake = node, wake
        handle: Any = node.context.handle
        with handle:
            self.guard = rclpy_implementation.GuardCondition(handle)
        self._ended = threading.Event()
        self._thread = threading.Thread(
            target=self._watch, args=(SetBack(_AT_FIRST),), name="alarm", daemon=True
        )

    def __enter__(self) -> Alarm:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self, set_back: SetBack) -> None:
        due: list[float] = []
        while not self._ended.wait(_PERIOD):
            if set_back.is_seen():
                self.guard.trigger_guard_condition()
                self._wake()
                due = [time.monotonic() + later for later in _AGAIN]
            if due and time.monotonic() >= due[0]:
                del due[0]
                self._speak_up()

    def _speak_up(self) -> None:
        """Make a publisher on a topic of every node.

        Where ROS has just been shut down there is no wait to end.
        """
        with suppress(RuntimeError, NotInitializedException):
            silent = PublisherEventCallbacks(use_default_callbacks=False)
            publisher = self._node.create_publisher(
                ParameterEvent, "/parameter_events", 1, event_callbacks=silent
            )
            self._node.destroy_publisher(publisher)


_AT_FIRST = ahead()  # before any node was made: the time of day may have been set back since
