"""What viewers of ROS get: the car as URDF, and the channels that layouts name."""

from __future__ import annotations

import json
import math
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from xml.etree.ElementTree import fromstring, parse

import pytest
import yaml

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire.layout import empty_message, message_class
from ev_sim.commands.exports import print_urdf
from ev_sim.dashboard import ros_views
from ev_sim.report.page.top_view import PREFIX

CONFIG = Path(__file__).parents[2] / "config" / "layouts"
VIEWED = {**dict.fromkeys(("pose.x", "pose.y"), 3.0), f"{PREFIX}heading": 1.2, f"{PREFIX}wheel_angle.front_left": 0.3}
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
    named = [displays[kind][key]["Value"] for kind, key in (("Odometry", "Topic"), ("MarkerArray", "Topic"))]
    described = displays["RobotModel"]["Description Topic"]
    assert {*named, described["Value"]} == {f"/ev/{name}" for name in OWN}
    assert described["Durability Policy"] == "Transient Local"  # it is published once
    assert (manager["Global Options"]["Fixed Frame"], manager["Views"]["Current"]["Target Frame"]) == (
        "odom",
        "base_link",
    )


TWIST = ("twist.longitudinal", "twist.lateral", "twist.yaw_rate")
TF_TYPE = ros_views.VIEWS["/tf"]
TF = message_class(TF_TYPE) if find_spec("tf2_msgs") else SimpleNamespace


class Ear:
    """A node that keeps what is published on each topic."""

    def __init__(self):
        self.heard = {}

    def create_publisher(self, kind, name, quality):
        return SimpleNamespace(publish=lambda message: self.heard.update({name: message}))


def test_tf_has_a_frame_for_each_link_of_the_urdf(monkeypatch):
    """With the message of tf2_msgs where that is installed, which is not on PyPI, else with one that has its field."""
    monkeypatch.setattr(ros_views, "message_class", lambda kind: TF if kind == TF_TYPE else message_class(kind))
    node, said = Ear(), []
    ros_views.RosViews(node, said.append).publish(2.5, {**VIEWED, **dict.fromkeys(TWIST, 0.0)}, Vehicle())
    frames = {each.child_frame_id: each for each in node.heard["/tf"].transforms}
    assert set(frames) == {
        link.get("name") for link in fromstring(node.heard["robot_description"].data).findall("link")
    }
    base, wheel = frames["base_link"], frames["front_left_wheel"]
    assert (base.header.frame_id, wheel.header.frame_id) == ("odom", "base_link")
    assert {(each.header.stamp.sec, each.header.stamp.nanosec) for each in frames.values()} == {(2, 500_000_000)}
    assert (base.transform.translation.x, base.transform.translation.y) == (3.0, 3.0)
    assert 2.0 * math.atan2(base.transform.rotation.z, base.transform.rotation.w) == pytest.approx(1.2)
    assert 2.0 * math.atan2(wheel.transform.rotation.z, wheel.transform.rotation.w) == pytest.approx(0.3)
    missing = {
        name for name, kind in ros_views.VIEWS.items() if name != "/tf" and find_spec(kind.split("/")[0]) is None
    }
    assert {line.split()[1].rstrip(":") for line in said} == missing


def test_the_urdf_has_the_geometry_of_the_vehicle_file(capsys):
    print_urdf(["audi_a2"])
    robot = fromstring(capsys.readouterr().out)
    joints = {joint.get("name"): joint for joint in robot.findall("joint")}
    assert tuple(joints) == WHEEL_NAMES
    places = {name: [float(n) for n in joint.find("origin").get("xyz").split()] for name, joint in joints.items()}
    assert places["front_left"][0] - places["rear_left"][0] == pytest.approx(2.405)  # wheelbase, m
    assert places["front_left"][1] - places["front_right"][1] == pytest.approx(1.462)  # track, m
    assert places["rear_left"][0] == pytest.approx(-1.08225)  # the centre of mass is the origin
    assert {place[2] for place in places.values()} == {0.294}  # the wheels stand on the ground
    assert len({link.get("name") for link in robot.findall("link")}) == 1 + 4


def test_an_unknown_vehicle_is_one_line():
    with pytest.raises(SystemExit, match="error: unknown vehicle 'audi'; did you mean audi_a2"):
        print_urdf(["audi"])
