"""What a process has said last is lost if it ends before that is heard."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.duration import Duration
from rclpy.publisher import Publisher

_AT_ONCE = Duration()
_A_MOMENT = 0.002  # s


def wait_until_heard(publisher: Publisher, given_up: float, is_wanted: Callable[[], bool] = lambda: True) -> None:
    """Wait until everything is acknowledged, up to a time of the monotonic clock, for as long as it is wanted.

    The middleware's own time-out may go by the time of day (`alarm`).
    """
    while not publisher.wait_for_all_acked(_AT_ONCE) and time.monotonic() < given_up and is_wanted():
        time.sleep(_A_MOMENT)
