"""Runs stepped nodes: polls what their next steps wait for and sleeps only when nothing of that has arrived.

rclpy's executors build a wait set of everything for every message, services included. Here a step wakes up for one
subscription, its last input, and polls the others; services, and so parameters, are looked at now and then, and what
there may be besides goes through an ordinary executor.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Protocol

from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.service import Service
from rclpy.subscription import Subscription

_SERVICE_PERIOD = 0.05  # s between looks at services


class Spinnable(Protocol):
    """What `spin` asks of a node; lower polling places come first."""

    polling_place: int

    def poll(self) -> bool:
        """Take what is waited for; False if nothing was there."""

    def sweep(self) -> None:
        """Take everything else too."""

    def awaits(self) -> Subscription | None:
        """The subscription to wake up for, None to sleep the whole time."""

    def wake_up_within(self) -> float:
        """Seconds to sleep at most."""

    def idle(self) -> None:
        """There was nothing to take."""


def spin(nodes: Sequence[Spinnable], finished: Callable[[], bool]) -> None:
    """Run nodes of one context until `finished` says so or ROS is shut down."""
    nodes = sorted(nodes, key=lambda node: node.polling_place)
    context = nodes[0].context  # type: ignore[attr-defined]
    executor = SingleThreadedExecutor(context=context)
    for node in nodes:
        executor.add_node(node)  # type: ignore[arg-type]
    services = [service for node in nodes for service in node.services]  # type: ignore[attr-defined]
    next_look = 0.0
    while context.ok() and not finished():
        progressed = False
        for node in nodes:
            progressed |= node.poll()
        if not progressed:
            for node in nodes:
                node.idle()
            if not _wait(nodes):
                for node in nodes:
                    node.sweep()
        if time.monotonic() >= next_look and context.ok():
            for service in services:
                _answer(service)
            executor.spin_once(timeout_sec=0.0)
            next_look = time.monotonic() + _SERVICE_PERIOD
    executor.shutdown(timeout_sec=0.0)


def _answer(service: Service) -> None:
    """Answer all calls that have arrived; the executor would look at one thing of one node at a time."""
    while True:
        with service.handle:
            request, header = service.handle.service_take_request(service.srv_type.Request)
        if header is None:
            return
        service.send_response(service.callback(request, service.srv_type.Response()), header)


def _wait(nodes: Sequence[Spinnable]) -> bool:
    """Sleep until an awaited message arrives; False if none has within the time that the nodes allow."""
    awaited = [subscription for node in nodes if (subscription := node.awaits()) is not None]
    timeout = min([node.wake_up_within() for node in nodes])
    if not awaited:
        time.sleep(timeout)
        return False
    context = nodes[0].context  # type: ignore[attr-defined]
    with context.handle:
        wait_set = rclpy_implementation.WaitSet(len(awaited), 0, 0, 0, 0, 0, context.handle)
        for subscription in awaited:
            wait_set.add_subscription(subscription.handle)
        wait_set.wait(int(timeout * 1e9))
        return bool(wait_set.get_ready_entities("subscription"))
