"""What viewers of ROS get: the car as URDF, and the channels that layouts name."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree.ElementTree import fromstring, parse

import pytest

from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire.layout import empty_message
from ev_msgs_py.wire.message_classes import message_class
from ev_sim.commands.urdf import main

CONFIG = Path(__file__).parents[2] / "config" / "layouts"
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


def test_the_urdf_has_the_geometry_of_the_vehicle_file(capsys):
    main(["audi_a2"])
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
    with pytest.raises(SystemExit, match="error: unknown vehicle 'audi'; known: audi_a2"):
        main(["audi"])
