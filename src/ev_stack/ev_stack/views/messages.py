"""Messages that show a car to viewers, serialized without the packages of their definitions.

The definitions are those of rosbags; the bag has them embedded. Each moving message is written
once, and the numbers of an instant are put into its bytes.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from rosbags.typesys.store import Nodetype

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.recording.bag_writer import ros_types
from ev_stack.recording.recording import Recording
from ev_stack.recording.shown import Message, View
from ev_stack.recording.spool import put, put_stamps
from ev_stack.views.car import PREFIX, mean_load, vehicle_in, view_channels, wheels_of
from ev_stack.views.urdf import BASE, BODY, body_height, steering_of, urdf, wheel_link

ODOM = "odom"
TF = View("/tf", "tf2_msgs/msg/TFMessage")
TF_STATIC = View("/tf_static", "tf2_msgs/msg/TFMessage", lasts=True)
ODOMETRY = View("odometry", "nav_msgs/msg/Odometry")
FORCES = View("tyre_force_markers", "visualization_msgs/msg/MarkerArray")
DESCRIPTION = View("robot_description", "std_msgs/msg/String", lasts=True)
PARAMETERS = View("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
VIEWS = (TF, TF_STATIC, ODOMETRY, FORCES, DESCRIPTION)

_FORCE = (0.75, 0.16, 0.26, 1.0)  # colour
_SHAFT, _HEAD = 0.04, 0.1  # m, diameters of an arrow
_LENGTH = 1.5  # m, of the arrow of a mean wheel load, as on the page
_MARKED_STAMP = (0x5E0C0DE5, 0x2A0C0DE5)  # s, ns: what nothing else in a message has
_MARKED_NUMBER = 1e9  # and more
# and ParameterType
# bool stands before int: to Python True is an int.
_FIELDS = {bool: ("bool", 1), int: ("integer", 2), float: ("double", 3), str: ("string", 4)}
_ARRAYS = 5  # what ParameterType has an array of them above


def message(kind: str, **given: Any) -> Any:
    """A message of a type, its fields given, else zero or empty."""
    types = ros_types()
    fields = dict(types.fielddefs[kind][1])
    return types.types[kind](
        **{name: given.get(name, _empty(field)) for name, field in fields.items()}
    )


def _empty(field: tuple[Any, Any]) -> Any:
    node, what = field
    if node is Nodetype.NAME:
        return message(what)
    if node is Nodetype.BASE:
        return "" if what[0] == "string" else 0
    (element, kind), size = what
    if element is Nodetype.NAME or kind[0] == "string":
        return []
    return np.zeros(size if node is Nodetype.ARRAY else 0, kind[0])


def serialized(kind: str, content: Any) -> bytes:
    """The bytes of a message, CDR."""
    return bytes(ros_types().serialize_cdr(content, kind))


class Template:
    """A serialized message with the places of its stamps and numbers.

    `make` returns it for a stamp and as many numbers.
    """

    def __init__(self, view: View, make: Callable[[Any, Sequence[float]], Any], count: int) -> None:
        stamp = message(
            "builtin_interfaces/msg/Time", sec=_MARKED_STAMP[0], nanosec=_MARKED_STAMP[1]
        )
        # A different mark for each number, so that the place of each is found in the bytes.
        marks = [_MARKED_NUMBER + place for place in range(count)]
        data = serialized(view.message_type, make(stamp, marks))
        self._bytes = np.frombuffer(data, np.uint8)
        mark = re.escape(struct.pack("<iI", *_MARKED_STAMP))
        self._stamps = [found.start() for found in re.finditer(mark, data, re.DOTALL)]
        # `index` raises where `make` leaves out a number: a template with a gap would be a silent
        # fault.
        self._numbers = [data.index(struct.pack("<d", mark)) for mark in marks]

    def filled(self, stamps_ns: np.ndarray, numbers: Sequence[np.ndarray]) -> list[bytes]:
        """The messages of instants [ns] (n,), with their numbers, each (n,)."""
        messages = np.tile(self._bytes, (len(stamps_ns), 1))
        for place in self._stamps:
            put_stamps(messages, place, stamps_ns)
        for place, values in zip(self._numbers, numbers, strict=True):
            put(messages, place, np.ascontiguousarray(values, "<f8"))
        return [each.tobytes() for each in messages]


class _Moving(NamedTuple):
    template: Template
    numbers: Callable[[Mapping[str, np.ndarray]], list[np.ndarray]]


@dataclass(frozen=True)
class CarViews:
    """Messages of the car of a namespace; `parameters` are those of its nodes, by name."""

    namespace: str
    car: Vehicle
    rear_is_steered: bool = False
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def lasting(self) -> Iterator[Message]:
        """Once, at the beginning."""
        text = urdf(self.car, self.rear_is_steered)
        yield self._named(DESCRIPTION, message(DESCRIPTION.message_type, data=text))
        if not self.car.suspension.rolls:
            still = self._body_transform(message("builtin_interfaces/msg/Time"))
            yield self._named(TF_STATIC, message(TF_STATIC.message_type, transforms=[still]))
        for node, values in self.parameters.items():
            # ROS has no type for an empty list.
            declared = [
                _parameter(name, value) for name, value in values.items() if value not in ([], ())
            ]
            full_name = f"{self.namespace.rstrip('/')}/{node}"
            yield self._named(
                PARAMETERS,
                message(PARAMETERS.message_type, node=full_name, new_parameters=declared),
            )

    def moving(self, stamps_ns: np.ndarray, run: Recording) -> Iterator[tuple[View, list[bytes]]]:
        """Messages at instants with these stamps [ns] (n,), as far as the recording has numbers."""
        at = {**run.channels, **view_channels(run, self.car)}
        for view, (template, numbers) in self._moving.items():
            try:
                values = numbers(at)
            # A plant without tyres has no forces, and so no arrows.
            except KeyError:
                continue
            yield view.within(self.namespace), template.filled(stamps_ns, values)

    def _named(self, view: View, content: Any) -> Message:
        return Message(view.within(self.namespace), serialized(view.message_type, content))

    @cached_property
    def _moving(self) -> dict[View, _Moving]:
        def forces(at: Mapping[str, np.ndarray]) -> list[np.ndarray]:
            # Metres of an arrow for each newton.
            scale = _LENGTH / mean_load(self.car)
            ways = [
                (f"tire_forces.{way}_force", name)
                for name in WHEEL_NAMES
                for way in ("longitudinal", "lateral")
            ]
            return [scale * at[f"{way}.{name}"] for way, name in ways]

        count = 4 + 4 * len(WHEEL_NAMES)
        rolls = self.car.suspension.rolls
        transforms = Template(TF, self._transforms, count + 2 if rolls else count)
        return {
            TF: _Moving(transforms, _frames_with_roll if rolls else _frames),
            ODOMETRY: _Moving(Template(ODOMETRY, _odometry, 7), _pose_and_twist),
            FORCES: _Moving(Template(FORCES, _arrows, 2 * len(WHEEL_NAMES)), forces),
        }

    def _transforms(self, stamp: Any, numbers: Sequence[float]) -> Any:
        x, y, *rest = numbers
        z, w, *rest = rest
        found = [_transform(stamp, ODOM, BASE, (x, y, 0.0), z=z, w=w)]
        for wheel in wheels_of(self.car):
            steer_z, steer_w, roll_y, roll_w, *rest = rest
            steered, place = steering_of(wheel.name), (wheel.x, wheel.y, wheel.radius)
            found.append(_transform(stamp, BASE, steered, place, z=steer_z, w=steer_w))
            found.append(_transform(stamp, steered, wheel_link(wheel.name), y=roll_y, w=roll_w))
        if rest:
            found.append(self._body_transform(stamp, x=rest[0], w=rest[1]))
        return message(TF.message_type, transforms=found)

    def _body_transform(self, stamp: Any, **rotation: float) -> Any:
        return _transform(stamp, BASE, BODY, (0.0, 0.0, body_height(self.car)), **rotation)


def views_of_nodes(namespace: str, parameters: Mapping[str, Mapping[str, Any]]) -> CarViews:
    """The views of the car that the plant has; ParameterError if its parameters describe none."""
    return CarViews(
        namespace, vehicle_in(parameters.get(MASTER, {})), "rear_steering" in parameters, parameters
    )


def _transform(
    stamp: Any, parent: str, child: str, place: Sequence[float] = (0.0, 0.0, 0.0), **rotation: float
) -> Any:
    made = message(
        "geometry_msgs/msg/TransformStamped", header=_header(stamp, parent), child_frame_id=child
    )
    to = made.transform.translation
    to.x, to.y, to.z = place
    made.transform.rotation = message("geometry_msgs/msg/Quaternion", **(rotation or {"w": 1.0}))
    return made


def _header(stamp: Any, frame: str) -> Any:
    return message("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def _frames(at: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    found = [at[f"pose.{name}"] for name in ("x", "y", "orientation_z", "orientation_w")]
    for name in WHEEL_NAMES:
        for angle in (at[f"{PREFIX}wheel_angle.{name}"], at[f"wheel_states.position.{name}"]):
            # The quaternion of a rotation about one axis.
            found += [np.sin(angle / 2), np.cos(angle / 2)]
    return found


def _frames_with_roll(at: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    found = _frames(at)
    upright = np.zeros_like(found[0])
    # A plant without loads, such as kinematic, rolls no body.
    sine = at.get("imu.roll.orientation_x", upright)
    return [*found, sine, at.get("imu.roll.orientation_w", upright + 1.0)]


def _odometry(stamp: Any, numbers: Sequence[float]) -> Any:
    made = message(ODOMETRY.message_type, header=_header(stamp, ODOM), child_frame_id=BASE)
    position, turned, twist = made.pose.pose.position, made.pose.pose.orientation, made.twist.twist
    position.x, position.y, turned.z, turned.w, twist.linear.x, twist.linear.y, twist.angular.z = (
        numbers
    )
    return made


def _pose_and_twist(at: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    pose = [f"pose.{name}" for name in ("x", "y", "orientation_z", "orientation_w")]
    return [at[name] for name in (*pose, "twist.longitudinal", "twist.lateral", "twist.yaw_rate")]


def _arrows(stamp: Any, numbers: Sequence[float]) -> Any:
    """Force of the road on each tyre, in the axes of the wheel."""
    kind, point, found = "visualization_msgs/msg/Marker", "geometry_msgs/msg/Point", []
    for place, name in enumerate(WHEEL_NAMES):
        along, across = numbers[2 * place : 2 * place + 2]
        arrow = message(kind, header=_header(stamp, steering_of(name)), ns="tyre_forces", id=place)
        arrow.points = [message(point), message(point, x=along, y=across)]
        arrow.scale.x, arrow.scale.y = _SHAFT, _HEAD
        arrow.color.r, arrow.color.g, arrow.color.b, arrow.color.a = _FORCE
        arrow.pose.orientation.w = 1.0
        found.append(arrow)
    return message(FORCES.message_type, markers=found)


def _parameter(name: str, value: Any) -> Any:
    is_array = isinstance(value, (list, tuple))
    field, kind = _FIELDS[_kind_of(value[0] if is_array else value)]
    kind_of_array = kind + _ARRAYS
    array = (
        value
        if field == "string"
        else np.array(value, {"bool": bool, "integer": "i8", "double": "f8"}[field])
    )
    given = (
        {f"{field}_array_value": array, "type": kind_of_array}
        if is_array
        else {f"{field}_value": value, "type": kind}
    )
    return message(
        "rcl_interfaces/msg/Parameter",
        name=name,
        value=message("rcl_interfaces/msg/ParameterValue", **given),
    )


def _kind_of(value: Any) -> type:
    return next(kind for kind in _FIELDS if isinstance(value, kind))
