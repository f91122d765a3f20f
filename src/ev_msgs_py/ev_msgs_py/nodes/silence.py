"""Whom a run waits for, in words."""

from __future__ import annotations

import time

from rclpy.node import Node

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import REQUIRED, ROLES
from ev_msgs_py.lockstep.stepper import WRITERS


class Silence:
    """Names the nodes that do not answer, and again when more is known: a killed one leaves the graph seconds later."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.answered()

    def answered(self) -> None:
        """A step was taken; the clock is read when nothing comes after it."""
        self._since: float | None = None
        self._said: tuple[object, ...] = ()

    def name_after(self, timeout: float, missing: tuple[type, ...], now: int) -> None:
        """Say who is missing at a stamp, once every `timeout` seconds of wall time."""
        wall = time.monotonic()
        if self._since is None:
            self._since = self._named = wall
        if wall - self._named <= timeout:
            return
        self._named = wall
        space = self._node.get_namespace()
        there = {name for name, where in self._node.get_node_names_and_namespaces() if where == space}
        wanted = {*REQUIRED, *(WRITERS[kind] for kind in missing)}
        gone = [role for role in ROLES if role in wanted and role not in there]
        where = f"not in the graph: {', '.join(gone)}" if gone else "all nodes are in the graph, one does not answer"
        if (where, missing) != self._said:
            self._said = where, missing
            waits = ", ".join([f"{kind.__name__} of {WRITERS[kind]}" for kind in missing] or ["the recorder"])
            at = stamps.to_seconds(now)
            self._node.get_logger().error(f"waiting for {waits} at {at} s for {wall - self._since:.1f} s; {where}")
