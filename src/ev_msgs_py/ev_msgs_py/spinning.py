"""Runs stepped nodes: polls their subscriptions in graph order and sleeps only when nothing has arrived.

rclpy's executors rebuild their wait set for every message. Here one wait set is kept, it watches only the input that
a step still waits for, and everything else is polled; services and parameters go through an ordinary executor.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.subscription import Subscription

from ev_msgs_py.stepped_node import SteppedNode

_SERVICE_PERIOD = 0.05  # s between looks at services while messages keep coming


def spin(nodes: Sequence[SteppedNode], finished: Callable[[], bool]) -> None:
    """Run nodes of one context until `finished` says so or ROS is shut down."""
    context = nodes[0].context
    executor = SingleThreadedExecutor(context=context)
    for node in nodes:
        executor.add_node(node)
    services = [service for node in nodes for service in node.services]
    next_look = 0.0
    while context.ok() and not finished():
        progressed = False
        for node in nodes:
            progressed |= node.poll()
        called = False
        if not progressed:
            for node in nodes:
                node.idle()
            awaited = [subscription for node in nodes for subscription in node.awaits()]
            timeout = min(node.wake_up_within() for node in nodes)
            called = _wait(context, awaited, services, timeout)
        if called or time.monotonic() >= next_look:
            executor.spin_once(timeout_sec=0.0)
            next_look = time.monotonic() + _SERVICE_PERIOD
    executor.shutdown(timeout_sec=0.0)


def _wait(context, subscriptions: Sequence[Subscription], services: Sequence, timeout: float) -> bool:
    """Sleep until a message or a call arrives; True if a service is called."""
    with context.handle:
        wait_set = rclpy_implementation.WaitSet(len(subscriptions), 0, 0, 0, len(services), 0, context.handle)
        for subscription in subscriptions:
            wait_set.add_subscription(subscription.handle)
        for service in services:
            wait_set.add_service(service.handle)
        wait_set.wait(int(timeout * 1e9))
        return bool(wait_set.get_ready_entities("service"))
