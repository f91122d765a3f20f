"""Where the fields of a signal stand in its message, as declared, and messages in the classes of ROS."""

from array import array
from functools import cache
from importlib import import_module
from typing import Any

from ev_msgs_py.contract.fields import Shape
from ev_msgs_py.contract.topics import JOINT_STATE, Topic
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import quoted

_ARRAYS = ("position", "velocity", "effort")


class MessageError(ValueError):
    """A message was refused; the text has the field, the value, and what is allowed."""


def _in_message(shape: Shape) -> list[str]:
    """The place of each channel, as its field declares it."""
    places = []
    for field in shape.fields.values():
        ends = WHEEL_NAMES if shape.per_wheel else ("",)
        places += [field.place.format(wheel=end) for end in ends]
    return places


def joint_names(topic: Topic) -> list[str]:
    """The joints of a JointState in the order in which the fields name them; none of another message."""
    if topic.message_type != JOINT_STATE:
        return []
    return list(dict.fromkeys(place.partition(".")[0] for place in _in_message(topic.shape)))


def paths(topic: Topic) -> list[str]:
    """The path of each channel in the message: twist.linear.x, effort[2]."""
    names = joint_names(topic)
    if not names:
        return _in_message(topic.shape)
    joints = (place.split(".") for place in _in_message(topic.shape))
    return [f"{kind}[{names.index(joint)}]" for joint, kind in joints]


def empty_message(topic: Topic, message_class: type) -> Any:
    """A message with all that is constant in it; an array of joints that no field uses stays empty."""
    message = message_class()
    getattr(message, "header", message).frame_id = topic.frame
    names = joint_names(topic)
    if names:
        message.name = names
        for kind in _used_arrays(topic):
            setattr(message, kind, array("d", bytes(8 * len(names))))
    if hasattr(message, "orientation_covariance"):
        message.orientation_covariance[0] = -1.0  # an Imu that measures no orientation
    return message


def _used_arrays(topic: Topic) -> list[str]:
    used = {path.partition("[")[0] for path in paths(topic)}
    return [kind for kind in _ARRAYS if kind in used]


def numbers_in(topic: Topic, message: Any) -> list[float]:
    """The numbers of a message object, joints in any order; MessageError if names or numbers are missing.

    A message may leave out in which frame its numbers are, but not name another one.
    """
    frame = getattr(message, "header", message).frame_id
    if frame not in ("", topic.frame):
        raise MessageError(f"frame_id is {quoted(frame)}, allowed is {quoted(topic.frame)}")
    names = joint_names(topic)
    if not names:
        return [_at(message, path) for path in paths(topic)]
    if sorted(message.name) != sorted(names):
        raise MessageError(f"joint names are {list(message.name)}, allowed are {names}")
    for kind in _used_arrays(topic):
        count = len(getattr(message, kind))
        if count != len(names):
            raise MessageError(f"{kind} has {count} numbers, allowed are {len(names)}, one per joint")
    order = list(message.name)
    found = []
    for path in paths(topic):
        kind, _, place = path.rstrip("]").partition("[")
        found.append(getattr(message, kind)[order.index(names[int(place)])])
    return found


def _at(message: Any, path: str) -> float:
    for name in path.split("."):
        message = getattr(message, name)
    number: float = message
    return number


@cache
def message_class(message_type: str) -> type:
    """The class of a type name such as sensor_msgs/msg/JointState."""
    package, kind, name = message_type.split("/")
    found: type = getattr(import_module(f"{package}.{kind}"), name)
    return found
