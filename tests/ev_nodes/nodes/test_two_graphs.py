"""Two nodes of one name, or two graphs of one namespace: right numbers, or a named cause."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import rclpy
from helpers.ros_graph import (
    NAMESPACE,
    NODES,
    Graph,
    graph,
    offline_hash,
    publisher,
    recorded_hash,
    shchur,
)
from rclpy.context import Context
from rclpy.node import Node

from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of
from ev_stack.running.offline import RECORDER

pytestmark = pytest.mark.slow

OTHER = 7.0  # N m, a torque that the run does not give
TWINS = "2 nodes are called /ev/asr, expected one: the run may not be reproducible"


@contextmanager
def another_process(nodes: Graph) -> Iterator[Context]:
    """A participant of its own in the domain of a graph, as another process would be."""
    context = Context()
    rclpy.init(context=context, domain_id=nodes.context.get_domain_id())
    try:
        yield context
    finally:
        context.try_shutdown()


class Twin:
    """A second traction control, which commands other torques."""

    def __init__(self, nodes: Graph, context: Context) -> None:
        self.node = Node("asr", context=context, namespace=NAMESPACE)
        self._publisher = publisher(self.node, TOPICS[WheelTorqueCommand])
        self._nodes = nodes
        self._frame = Frame()
        self._frame.numbers[:] = numbers_of([OTHER] * len(self._frame.numbers))

    def command(self) -> None:
        """Answer the present instant of the plant before the node of the role does."""
        now = self._nodes.nodes["plant"].now
        self._publisher.handle.publish_raw(format_of(WheelTorqueCommand).pack(now, self._frame))


def named_by(nodes: Graph) -> set[str]:
    """Nodes that have reported the twin."""
    return {each.partition(": ")[0] for each in nodes.probe.reports if each.endswith(TWINS)}


def test_a_node_that_is_started_twice_is_named_and_the_first_one_counts(tmp_path: Path):
    """Time rests until both readers of the command have named the twin."""
    run = shchur(1.0, plant__real_time_factor=0.5)
    with graph(run, tmp_path) as nodes, another_process(nodes) as elsewhere:
        nodes.run(lambda: nodes.time >= 0.1 and nodes.can_be_called())
        nodes.call("pause")
        twin = Twin(nodes, elsewhere)

        def is_named() -> bool:
            twin.command()
            return named_by(nodes) == {"/ev/plant", "/ev/recorder"}

        nodes.run(is_named)
        nodes.call("resume")
        nodes.run(lambda: twin.command() or nodes.nodes[RECORDER].done)
        twin.node.destroy_node()
    assert recorded_hash(tmp_path) == offline_hash(run)


def test_numbers_of_a_wrong_node_that_was_there_first_are_never_without_a_line(tmp_path: Path):
    """The plant follows the twin, which came first, until the other one is there: the signals are others."""
    run = shchur(1.0)
    with (
        graph(run, tmp_path, names=[name for name in NODES if name != "asr"]) as nodes,
        another_process(nodes) as elsewhere,
    ):
        twin = Twin(nodes, elsewhere)
        nodes.run(lambda: twin.command() or nodes.time >= 0.1)
        nodes.start("asr")
        nodes.run(lambda: bool(named_by(nodes)))
        twin.node.destroy_node()
        nodes.run()
    assert recorded_hash(tmp_path) != offline_hash(run)


@pytest.mark.weekly
def test_two_graphs_of_one_namespace_name_each_other_and_give_no_number(tmp_path: Path):
    """No node takes messages of two: both graphs stand until one is left, with right numbers."""
    run = shchur(0.3)
    with graph(run, tmp_path / "first") as nodes, another_process(nodes) as elsewhere:
        second = Graph(elsewhere, run, tmp_path / "second")
        twins = "2 nodes are called /ev/plant, expected one"
        while not any(twins in report for report in nodes.probe.reports):
            nodes.run_rounds()
            second.run_rounds()
        assert len(nodes.probe.reports) == len(set(nodes.probe.reports)), "each node says it once"
        assert nodes.time == second.time == 0.0
        for name in list(second.nodes):
            second.kill(name)
        nodes.run()
    assert recorded_hash(tmp_path / "first") == offline_hash(run)
