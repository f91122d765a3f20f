"""Ends of a topic that do not fit are named: of another type, or without messages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from helpers.ros_graph import NAMESPACE, NODES, Graph, graph, node_of, publisher, shchur
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray

from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import BodyPose, WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.topics import JOINT_STATE, TOPICS
from ev_msgs_py.wire import format_of, message_class
from ev_nodes.stepping.signal_io import QUALITY

pytestmark = pytest.mark.slow

BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PUNCTUAL = QoSProfile(depth=1, deadline=Duration(seconds=1.0))
TIME_OF_DAY = 1_790_000_000_123_456_789  # ns


@contextmanager
def another_process(nodes: Graph, *names: str) -> Iterator[list[Node]]:
    """Nodes of a participant of their own: one participant cannot have two types on a topic."""
    context = Context()
    rclpy.init(context=context, domain_id=nodes.context.get_domain_id())
    try:
        yield [Node(name, context=context, namespace=NAMESPACE) for name in names]
    finally:
        context.try_shutdown()


def others_than(*names: str) -> Sequence[str]:
    return [name for name in NODES if name not in names]


def reported(nodes: Graph, start: str) -> str:
    """The report that begins so, when it has come."""

    def found() -> list[str]:
        return [each for each in nodes.probe.reports if each.startswith(start)]

    nodes.run(lambda: bool(found()))
    nodes.run_rounds()
    assert len(found()) == 1
    return found()[0]


def test_whatever_has_another_type_is_named(tmp_path: Path):
    """A node of the user's own, and strangers that publish and that subscribe."""
    command, request = (TOPICS[kind].name for kind in (WheelTorqueCommand, WheelTorqueRequest))
    with (
        graph(shchur(0.5), tmp_path, names=others_than("asr")) as nodes,
        another_process(nodes, "asr", "stranger") as (asr, stranger),
    ):
        asr.create_publisher(Float64MultiArray, command, QUALITY)
        stranger.create_publisher(Float64MultiArray, request, QUALITY)
        stranger.create_subscription(Float64MultiArray, command, print, QUALITY)
        what = f"as std_msgs/msg/Float64MultiArray, expected {JOINT_STATE}"
        for line in (
            f"/ev/asr publishes /ev/{command} {what}",
            f"/ev/stranger publishes /ev/{request} {what}",
            f"/ev/stranger subscribes to /ev/{command} {what}",
        ):
            assert reported(nodes, f"/ev/plant: {line}") == f"/ev/plant: {line}"
        reasons = nodes.nodes["plant"].why_it_waits((WheelTorqueCommand,))
    assert reasons == [f"/ev/asr publishes /ev/{command} {what}"]


def test_the_input_of_a_node_that_is_best_effort_is_named(tmp_path: Path):
    """The master waits for the traction control, and that one for a request that never arrives."""
    topic = TOPICS[WheelTorqueRequest]
    with (
        graph(shchur(0.5), tmp_path, names=others_than("electronic_differential")) as nodes,
        another_process(nodes, "electronic_differential") as (own,),
    ):
        own.create_publisher(message_class(topic.message_type), topic.name, BEST_EFFORT)
        line = "/ev/electronic_differential publishes /ev/torque_request as best effort, expected reliable"
        assert reported(nodes, f"/ev/plant: {line}") == f"/ev/plant: {line}"
        assert nodes.nodes["plant"].why_it_waits((WheelTorqueCommand,)) == [line]


@pytest.mark.parametrize("quality", [LATCHED, PUNCTUAL], ids=["transient local", "deadline"])
def test_a_subscriber_that_receives_nothing_is_named_and_costs_no_number(
    quality: QoSProfile, tmp_path: Path
):
    topic = TOPICS[BodyPose]
    with (
        graph(shchur(20.0, plant__real_time_factor=0.1), tmp_path) as nodes,
        another_process(nodes, "viewer") as (viewer,),
    ):
        viewer.create_subscription(message_class(topic.message_type), topic.name, print, quality)
        line = reported(nodes, "/ev/plant: /ev/viewer receives nothing of /ev/pose: ")
        assert nodes.nodes["plant"].why_it_waits(()) == []
    assert ("transient local" if quality is LATCHED else "eadline") in line


def test_nothing_is_named_in_a_graph_that_fits(tmp_path: Path):
    """Subscribers of best effort receive what is reliable."""
    topic = TOPICS[BodyPose]
    with graph(shchur(0.5), tmp_path, names=others_than("driver")) as nodes:
        nodes.probe.create_subscription(
            message_class(topic.message_type), topic.name, print, BEST_EFFORT
        )
        plant = nodes.nodes["plant"]
        nodes.run_rounds()
        for _ in TOPICS:
            plant._name_misfits()
        nodes.start("driver")
        nodes.run_rounds()
        assert plant.why_it_waits(plant.stepper.reads) == []
        nodes.run()
        assert nodes.probe.reports == []


def test_a_node_of_another_namespace_is_named(tmp_path: Path):
    """The commonest mistake in starting nodes by hand.

    Without -r __ns:=/ev they are in the root.
    """
    with graph(shchur(0.5), tmp_path, names=others_than("asr")) as nodes:
        lost = node_of(nodes.context, "asr", nodes.parameters["asr"], namespace="/")
        nodes.run_rounds()
        reasons = nodes.nodes["plant"].why_it_waits((WheelTorqueCommand,))
        lost.destroy_node()
    assert reasons == ["not in the graph: asr (but /asr, expected in /ev)"]


def test_real_time_reports_a_stamp_of_no_step_once(tmp_path: Path):
    """Its torque fades, so it is reported and not only counted."""
    run = shchur(0.5, **{"*__mode": "realtime"})
    late = format_of(WheelTorqueCommand).pack(TIME_OF_DAY, Frame())
    with (
        graph(run, tmp_path, names=others_than("asr")) as nodes,
        another_process(nodes, "asr") as (own,),
    ):
        mouth: Any = publisher(own, TOPICS[WheelTorqueCommand])

        def is_reported() -> bool:
            mouth.handle.publish_raw(late)
            return bool(nodes.probe.reports)

        nodes.run(is_reported)
        nodes.run_rounds()
        reasons = nodes.nodes["plant"].why_it_waits((WheelTorqueCommand,))
    line = "torque_command at 1790000000.1234567 s ignored (reported once): 0.0 s is due, in steps of 0.01 s"
    assert nodes.probe.reports == [f"/ev/plant: {line}"]
    assert reasons[-1] == line


def test_a_node_that_has_not_stepped_yet_names_a_stamp_of_no_step(tmp_path: Path):
    """The traction control would wait for other inputs of that time for ever."""
    late = format_of(WheelTorqueRequest).pack(TIME_OF_DAY, Frame())
    with (
        graph(shchur(0.5), tmp_path, names=others_than("electronic_differential")) as nodes,
        another_process(nodes, "electronic_differential") as (own,),
    ):
        mouth: Any = publisher(own, TOPICS[WheelTorqueRequest])

        def is_reported() -> bool:
            mouth.handle.publish_raw(late)
            return any(each.startswith("/ev/asr") for each in nodes.probe.reports)

        nodes.run(is_reported)
        reasons = nodes.nodes["asr"].why_it_waits((WheelTorqueRequest,))
    what = "torque_request at 1790000000.1234567 s ignored (reported once): a multiple of 0.01 s is expected"
    assert reasons == [what]
