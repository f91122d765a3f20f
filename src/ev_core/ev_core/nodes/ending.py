"""How a node ends: its last words, and how its process leaves the graph.

How the process of a node leaves the graph.
A node that says goodbye takes its publishers out of the graph one by one. Who removes a publisher that it has heard
holds a lock of Fast DDS and waits for its own thread of timed events: if that is just about to announce its process,
and waits for the lock, the process is locked up for ever (https://github.com/eProsima/Fast-DDS/issues/6502). Nodes that
a runner has started end all together, and nobody is left who needs to know: they leave without a word. Who else has
followed the run misses them when their lease is over, after 4 s. Only what they hear they take out of the graph, which
makes nobody wait for a timer: who wants to know that its last word has arrived shall not wait for them.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher

from ev_core.nodes.stop_request import turn_deaf

_AT_ONCE = Duration()
_TO_BE_HEARD = 0.002  # s


def wait_until_heard(publisher: Publisher, given_up: float, is_wanted: Callable[[], bool] = lambda: True) -> None:
    """Wait until everything is acknowledged, up to a time of the monotonic clock, for as long as it is wanted.

    The middleware's own time-out may go by the time of day (`time_of_day`).
    """
    while not publisher.wait_for_all_acked(_AT_ONCE) and time.monotonic() < given_up and is_wanted():
        time.sleep(_TO_BE_HEARD)


SILENTLY = "EV_STACK_LEAVE_SILENTLY"  # variable of the environment: a runner sets it for its nodes


def stop_listening(node: Node) -> None:
    """Subscribe to nothing any more, so that nobody waits until this node has received something."""
    for subscription in list(node.subscriptions):
        node.destroy_subscription(subscription)


def leave(trouble: str | None = None) -> None:
    """Let the process end; SystemExit, with status 1 and a line on stderr, if there was trouble. No signal counts then.

    To be called while the node still lives: one that is forgotten says goodbye.
    """
    turn_deaf()
    if SILENTLY in os.environ:
        if trouble is not None:
            print(trouble, file=sys.stderr)
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0 if trouble is None else 1)
    rclpy.try_shutdown()
    if trouble is not None:
        sys.exit(trouble)
