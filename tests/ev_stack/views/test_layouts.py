"""Views of a run for viewers of ROS, and the channels that layouts name."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from xml.etree.ElementTree import fromstring, parse

import numpy as np
import yaml
from rclpy.serialization import deserialize_message

from ev_core.vehicle.description import Vehicle
from ev_doors.dashboard import ros_views
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.signals import BodyPose
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import empty_message, message_class
from ev_stack.recording.bag_writer import ros_types
from ev_stack.recording.recording import recording_of
from ev_stack.views.messages import VIEWS, CarViews

CONFIG = Path(__file__).parents[3] / "config" / "layouts"
OWN = ("odometry", "tyre_force_markers", "robot_description")  # of the node visualization


def test_the_layouts_name_topics_that_there_are():
    known = {f"/ev/{topic.name}": topic for topic in TOPICS.values()}
    for curve in parse(CONFIG / "plotjuggler.xml").iter("curve"):
        assert any(curve.get("name").startswith(f"{name}/") for name in known), curve.get("name")
    panels = json.loads((CONFIG / "foxglove.json").read_text())["configById"]
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", ())]
    assert paths
    for path in paths:
        name, _, rest = path.partition(".")
        message = empty_message(known[name], message_class(known[name].message_type))
        for part in rest.split("."):
            attribute, _, index = part.partition("[")
            message = getattr(message, attribute)
            message = message[int(index[:-1])] if index else message
        assert isinstance(message, float)
    assert set(panels["3D!car"]["topics"]) == {f"/ev/{name}" for name in OWN}


def test_rviz_shows_the_topics_of_the_node_in_a_frame_that_it_publishes():
    manager = yaml.safe_load((CONFIG / "car.rviz").read_text())["Visualization Manager"]
    displays = {display["Class"].rpartition("/")[2]: display for display in manager["Displays"]}
    named = [
        displays[kind][key]["Value"]
        for kind, key in (("Odometry", "Topic"), ("MarkerArray", "Topic"))
    ]
    described = displays["RobotModel"]["Description Topic"]
    assert {*named, described["Value"]} == {f"/ev/{name}" for name in OWN}
    assert described["Durability Policy"] == "Transient Local"  # it is published once
    assert (
        manager["Global Options"]["Fixed Frame"],
        manager["Views"]["Current"]["Target Frame"],
    ) == (
        "odom",
        "base_link",
    )


class _Lacking(dict):
    def __missing__(self, kind):
        raise ImportError(kind)


# Types by name, in the place of their classes; one package is missing.
KINDS = _Lacking(
    {
        view.message_type: view.message_type
        for view in VIEWS
        if "visualization" not in view.message_type
    }
)


class Ear:
    """A node that keeps what is published on each topic."""

    def __init__(self):
        self.heard = {}

    def get_namespace(self):
        return "/ev"

    def create_publisher(self, kind, name, quality):
        return SimpleNamespace(publish=lambda message: self.heard.update({name: (kind, message)}))


def test_a_run_that_is_watched_is_shown_by_the_packages_that_are_there(monkeypatch):
    """Their messages are serialized without them, here by stand-ins for the packages.

    One that is missing is named.
    """
    monkeypatch.setattr(ros_views, "message_class", lambda kind: KINDS[kind])
    node, notes = Ear(), []
    numbers = np.zeros((1, SIZE))
    numbers[0, PLACES[BodyPose]] = BodyPose.at(3.0, 4.0, 1.2)
    instant = recording_of(numbers, [TOPICS[signal] for signal in PLACES])
    views = ros_views.RosViews(node, notes.append)
    views.publish(instant, CarViews("/ev", Vehicle()))
    assert {name: kind for name, (kind, _) in node.heard.items()} == {
        view.within("/ev").name: view.message_type for view in VIEWS if view.message_type in KINDS
    }
    kind, data = node.heard["/tf"]
    base = ros_types().deserialize_cdr(data, kind).transforms[0]
    assert (base.transform.translation.x, base.transform.translation.y) == (3.0, 4.0)
    assert notes == [
        "no tyre_force_markers: visualization_msgs is not installed; a bag has it without (docs/live.md)"
    ]


def test_std_msgs_takes_the_bytes_of_a_description():
    """The package std_msgs is always installed."""
    described, *_ = CarViews("/ev", Vehicle()).lasting()
    assert (
        fromstring(
            deserialize_message(described.data, message_class("std_msgs/msg/String")).data
        ).tag
        == "robot"
    )
