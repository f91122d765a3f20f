"""Parameters that change while the graph runs: all of them between two steps, or none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from ev_msgs_py.lockstep.configuration import Configuration
from ev_msgs_py.nodes import ros_parameters


class LiveParameters:
    """The present configuration of a node; `changed(before, given)` is called when another one is taken over.

    `try_out(configuration)` makes what the new configuration needs; whatever it raises refuses the change.
    """

    def __init__(
        self,
        node: Node,
        configuration: Configuration,
        try_out: Callable[[Configuration], Any],
        changed: Callable[[Configuration, dict[str, Any], Any], None],
    ) -> None:
        self.configuration = configuration
        self._try_out, self._changed = try_out, changed
        ros_parameters.declare(node, configuration.entries())
        node.add_on_set_parameters_callback(self._on_set)

    def _on_set(self, changes: list[Parameter]) -> SetParametersResult:
        try:
            given = ros_parameters.asked_for(changes)
            if not given:
                return SetParametersResult(successful=True)
            configuration = self.configuration.changed(given)
            made = self._try_out(configuration)
        except Exception as error:  # also of a law that somebody has brought along
            return ros_parameters.refusal(error)
        before, self.configuration = self.configuration, configuration
        self._changed(before, given, made)
        return SetParametersResult(successful=True)
