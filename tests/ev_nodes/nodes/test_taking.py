"""Messages are taken with the identity of their publisher, whatever rclpy itself passes on."""

from __future__ import annotations

from helpers.patience import wait_until
from helpers.ros_graph import ros_domain
from rclpy.node import Node
from std_msgs.msg import String

from ev_nodes.rcl import taking
from ev_nodes.rcl.taking import taker_of
from ev_nodes.stepping.signal_io import QUALITY


def test_a_message_names_its_publisher_as_the_graph_does():
    """Each message has its own of two publishers of one topic; a long message arrives whole."""
    with ros_domain() as context:
        node = Node("node", context=context)
        subscription = node.create_subscription(String, "words", print, QUALITY, raw=True)
        take = taker_of(subscription.handle, String)
        assert take() is None
        names, senders = {}, []
        for name, length in (("first", 1), ("second", 100_000)):
            senders.append(Node(name, context=context))
            publisher = senders[-1].create_publisher(String, "words", QUALITY)
            wait_until(publisher.get_subscription_count)
            publisher.publish(String(data=name[0] * length))
            taken = []
            wait_until(lambda taken=taken: taken.append(take()) or taken[-1])
            message, gid, received = taken[-1]
            assert name.encode()[:1] * length in message
            assert received > 0
            names[name] = gid
        there = {
            each.node_name: bytes(each.endpoint_gid)
            for each in node.get_publishers_info_by_topic("words")
        }
        assert names == there
        assert take() is None


def test_without_the_c_library_by_its_name_messages_are_taken_by_rclpy(monkeypatch):
    """Systems with other names for their libraries use rclpy."""
    with ros_domain() as context:
        node = Node("node", context=context)
        subscription = node.create_subscription(String, "words", print, QUALITY, raw=True)
        assert taking.rcl(), "the wheels have it"
        monkeypatch.setattr("ev_nodes.rcl.taking.rcl", lambda: None)
        take = taker_of(subscription.handle, String)
        publisher = node.create_publisher(String, "words", QUALITY)
        wait_until(publisher.get_subscription_count)
        publisher.publish(String(data="short"))
        taken = []
        wait_until(lambda: taken.append(take()) or taken[-1])
        assert b"short" in taken[-1].message
