"""Messages for viewers of ROS beside the topics of the contract, where their packages exist."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

from ev_msgs_py.contract import stamps
from ev_msgs_py.wire import message_class
from ev_stack.recording.recording import Recording
from ev_stack.recording.shown import View
from ev_stack.views.messages import VIEWS, CarViews

# for subscribers that come later
_HELD = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RosViews:
    """Publisher of a car in the namespace of a node.

    `say` gets a line for each message package that is missing.
    """

    def __init__(self, node: Node, say: Callable[[str], None]) -> None:
        self._publishers: dict[View, Publisher] = {}
        self._described: CarViews | None = None
        for view in VIEWS:
            try:
                kind = message_class(view.message_type)
            except ImportError:
                package = view.message_type.partition("/")[0]
                say(
                    f"no {view.name}: {package} is not installed; a bag has it without"
                    " (docs/live.md)"
                )
                continue
            quality = _HELD if view.lasts else QoSProfile(depth=10)
            named = view.within(node.get_namespace())
            self._publishers[named] = node.create_publisher(kind, named.name, quality)

    def publish(self, instant: Recording, views: CarViews) -> None:
        """Publish what one instant shows of a car, and once what lasts of it."""
        if self._described is None or views.car != self._described.car:
            self._described = views
            for view, data in views.lasting():
                self._send(view, data)
        stamp = np.array([stamps.from_seconds(float(instant.time[0]))])
        for view, (data,) in self._described.moving(stamp, instant):
            self._send(view, data)

    def _send(self, view: View, data: bytes) -> None:
        if view in self._publishers:
            self._publishers[view].publish(data)
