"""What viewers of ROS want beside the topics of the contract, each as far as its message package is installed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from geometry_msgs.msg import Point, TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire import message_class
from ev_sim.report.page.top_view import PREFIX, car_of

_HEIGHT, _OVERHANG = 1.0, 1.35  # m, of the body that is drawn; the vehicle file has nothing about its looks
_WIDTH = 0.64  # of a wheel that is drawn, over its radius


def urdf(car: Vehicle) -> str:
    """The text of the file; joints have the names of the wheels, as in `wheel_states`."""
    shape = car_of(car)
    radius = shape["radius"]
    robot = Element("robot", name=car.name)
    body = SubElement(robot, "link", name="base_link")
    xs, ys = zip(*(wheel["place"] for wheel in shape["wheels"]), strict=True)
    centre = f"{(max(xs) + min(xs)) / 2:.6g} {(max(ys) + min(ys)) / 2:.6g} {radius + _HEIGHT / 2:.6g}"
    size = f"{max(xs) - min(xs) + _OVERHANG:.6g} {max(ys) - min(ys):.6g} {_HEIGHT:.6g}"
    _visual(body, "box", {"size": size}, centre, "0 0 0", "0.78 0.82 0.85 0.6")
    for wheel in shape["wheels"]:
        name = wheel["name"].replace(" ", "_")
        link = SubElement(robot, "link", name=f"{name}_wheel")
        cylinder = {"radius": f"{radius:.6g}", "length": f"{_WIDTH * radius:.6g}"}
        _visual(link, "cylinder", cylinder, "0 0 0", "1.5707963 0 0", "0.1 0.12 0.14 1")
        joint = SubElement(robot, "joint", name=name, type="continuous")
        SubElement(joint, "parent", link="base_link")
        SubElement(joint, "child", link=f"{name}_wheel")
        x, y = wheel["place"]
        SubElement(joint, "origin", xyz=f"{x:.6g} {y:.6g} {radius:.6g}", rpy="0 0 0")
        SubElement(joint, "axis", xyz="0 1 0")
    indent(robot)
    return tostring(robot, encoding="unicode") + "\n"


def _visual(link: Element, kind: str, size: dict[str, str], xyz: str, rpy: str, colour: str) -> None:
    visual = SubElement(link, "visual")
    SubElement(visual, "origin", xyz=xyz, rpy=rpy)
    SubElement(SubElement(visual, "geometry"), kind, size)
    material = SubElement(visual, "material", name=f"{link.get('name')}_colour")
    SubElement(material, "color", rgba=colour)


VIEWS = {  # name -> type; relative ones stand in the namespace of the graph
    "/tf": "tf2_msgs/msg/TFMessage",
    "odometry": "nav_msgs/msg/Odometry",
    "tyre_force_markers": "visualization_msgs/msg/MarkerArray",
    "robot_description": "std_msgs/msg/String",
}
_ODOM, _BASE = "odom", "base_link"
_HELD = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for subscribers that come later
_FORCE = (0.75, 0.16, 0.26, 1.0)  # colour
_SHAFT, _HEAD = 0.04, 0.1  # m, diameters of an arrow


class RosViews:
    """Publishes the car of a row of values; `say` gets a line on each message package that is missing."""

    def __init__(self, node: Node, say: Callable[[str], None]) -> None:
        self._publishers: dict[str, Any] = {}
        self._classes: dict[str, Any] = {}
        self._described: Vehicle | None = None
        for name, kind in VIEWS.items():
            try:
                self._classes[name] = message_class(kind)
            except ImportError:
                say(f"no {name}: {kind.partition('/')[0]} is not installed")
                continue
            quality = _HELD if name == "robot_description" else QoSProfile(depth=10)
            self._publishers[name] = node.create_publisher(self._classes[name], name, quality)

    def publish(self, time: float, at: Mapping[str, float], car: Vehicle) -> None:
        """Publish what the channels `at` an instant [s] show of a car; without a pose nothing but the car."""
        if car != self._described:
            self._described = car
            self._send("robot_description", lambda kind: kind(data=urdf(car)))
        if "pose.x" not in at or f"{PREFIX}heading" not in at:
            return
        stamp = {"sec": int(time), "nanosec": round(time % 1 * 1e9) % 1_000_000_000}
        self._send("/tf", lambda kind: kind(transforms=_transforms(stamp, at, car)))
        self._send("odometry", lambda kind: _odometry(kind(), stamp, at))
        if f"tire_forces.longitudinal_force.{WHEEL_NAMES[0]}" in at:
            self._send("tyre_force_markers", lambda kind: kind(markers=_arrows(stamp, at, car)))

    def _send(self, name: str, make: Callable[[Any], Any]) -> None:
        if name in self._publishers:
            self._publishers[name].publish(make(self._classes[name]))


def _headed(message: Any, stamp: Mapping[str, int], frame: str) -> Any:
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = stamp["sec"], stamp["nanosec"]
    return message


def _turned(quaternion: Any, angle: float) -> None:
    quaternion.z, quaternion.w = math.sin(angle / 2), math.cos(angle / 2)


def _transforms(stamp: Mapping[str, int], at: Mapping[str, float], car: Vehicle) -> list[TransformStamped]:
    base = _headed(TransformStamped(child_frame_id=_BASE), stamp, _ODOM)
    base.transform.translation.x, base.transform.translation.y = at["pose.x"], at["pose.y"]
    _turned(base.transform.rotation, at[f"{PREFIX}heading"])
    found = [base]
    shape = car_of(car)
    for name, wheel in zip(WHEEL_NAMES, shape["wheels"], strict=True):
        each = _headed(TransformStamped(child_frame_id=f"{name}_wheel"), stamp, _BASE)
        to = each.transform.translation
        to.x, to.y, to.z = *wheel["place"], shape["radius"]
        _turned(each.transform.rotation, at.get(f"{PREFIX}wheel_angle.{name}", 0.0))
        found.append(each)
    return found


def _odometry(message: Any, stamp: Mapping[str, int], at: Mapping[str, float]) -> Any:
    _headed(message, stamp, _ODOM).child_frame_id = _BASE
    message.pose.pose.position.x, message.pose.pose.position.y = at["pose.x"], at["pose.y"]
    _turned(message.pose.pose.orientation, at[f"{PREFIX}heading"])
    twist = message.twist.twist
    twist.linear.x, twist.linear.y = at["twist.longitudinal"], at["twist.lateral"]
    twist.angular.z = at["twist.yaw_rate"]
    return message


def _arrows(stamp: Mapping[str, int], at: Mapping[str, float], car: Vehicle) -> list[Any]:
    """Force of the road on each tyre, in the axes of the wheel; 1 m is 2/3 of a mean wheel load, as on the page."""
    kind = message_class("visualization_msgs/msg/Marker")
    per_metre = car.mass * GRAVITY / len(WHEEL_NAMES) / 1.5
    found = []
    for i, name in enumerate(WHEEL_NAMES):
        arrow = _headed(kind(ns="tyre_forces", id=i, type=kind.ARROW), stamp, f"{name}_wheel")
        along, across = (at[f"tire_forces.{way}_force.{name}"] / per_metre for way in ("longitudinal", "lateral"))
        arrow.points = [Point(), Point(x=along, y=across)]
        arrow.scale.x, arrow.scale.y = _SHAFT, _HEAD
        arrow.color.r, arrow.color.g, arrow.color.b, arrow.color.a = _FORCE
        arrow.pose.orientation.w = 1.0
        found.append(arrow)
    return found
