"""Frames as messages: serialized templates with the numbers of the frame at fixed places.

Messages are little-endian CDR with zeros for padding. The middleware leaves whatever was in memory
between the fields. Here equal messages are equal bytes, which the message formats rely on.

Making a message object, filling it and letting the middleware serialize it costs some fifty
microseconds, and as much to take one apart; a node does this several times per step. The places
never change within a topic, so a few copies of bytes do the same, between frame and message by runs
of numbers. What another sender wrote in another layout (joints in another order, no frame name) is
still read, by way of the message object.
"""

import math
import re
import struct
from array import array
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from operator import itemgetter
from typing import Any, NamedTuple

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import Shape, SignalError
from ev_msgs_py.contract.topics import JOINT_STATE, TOPICS, Topic
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import quoted

_ARRAYS = ("position", "velocity", "effort")
ENCAPSULATION = b"\x00\x01\x00\x00"  # plain CDR, little-endian
_KINDS = "boolean octet uint8 int8 uint16 int16 uint32 int32 uint64 int64 float double"
_CODES = dict(zip(_KINDS.split(), "?BBbHhIiQqfd", strict=True))  # of struct
_COLLECTION = re.compile(r"sequence<(?P<element>.+)>|(?P<member>.+)\[(?P<size>\d+)\]")
STAMP_AT = len(ENCAPSULATION)  # every message of the contract begins with its stamp
_STAMP = struct.Struct("<iI")


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
    """Joints of a JointState in the order of the fields; none of another message."""
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
    """Message with all that is constant in it; an array of joints that no field uses is empty."""
    message = message_class()
    getattr(message, "header", message).frame_id = topic.frame
    names = joint_names(topic)
    if names:
        message.name = names
        for kind in _used_arrays(topic):
            setattr(message, kind, array("d", bytes(8 * len(names))))
    places = _in_message(topic.shape)
    if hasattr(message, "orientation_covariance") and "orientation.w" not in places:
        message.orientation_covariance[0] = -1.0  # an Imu that measures no orientation
    return message


def _used_arrays(topic: Topic) -> list[str]:
    used = {path.partition("[")[0] for path in paths(topic)}
    return [kind for kind in _ARRAYS if kind in used]


def numbers_in(topic: Topic, message: Any) -> list[float]:
    """Numbers of a message object, joints in any order; MessageError if one is missing.

    A message may leave out in which frame its numbers are, but not name another one.
    """
    frame = getattr(message, "header", message).frame_id
    if frame not in ("", topic.frame):
        raise MessageError(f"frame_id is {quoted(frame)}, expected {quoted(topic.frame)}")
    names = joint_names(topic)
    if not names:
        return [_at(message, path) for path in paths(topic)]
    if sorted(message.name) != sorted(names):
        raise MessageError(f"joint names are {list(message.name)}, expected {names}")
    for kind in _used_arrays(topic):
        count = len(getattr(message, kind))
        if count != len(names):
            raise MessageError(f"{kind} has {count} numbers, expected {len(names)}, one per joint")
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


class Serialized:
    """The bytes of a ROS message with its encapsulation header, and the places of its numbers.

    `places` has, by path (twist.linear.x, position[3]), the offset in the bytes and the struct code
    of a number.
    """

    def __init__(self, message: Any) -> None:
        self.places: dict[str, tuple[int, str]] = {}
        self._body = bytearray()
        self._write_message(message, "")

    @property
    def bytes(self) -> bytes:
        """The whole message."""
        return ENCAPSULATION + bytes(self._body)

    def _write_message(self, message: Any, prefix: str) -> None:
        for name, kind in message.get_fields_and_field_types().items():
            self._write(kind, getattr(message, name), prefix + name)

    def _write(self, kind: str, value: Any, path: str) -> None:
        if collection := _COLLECTION.fullmatch(kind):
            if collection["element"]:
                self._write_number("I", len(value), f"{path}.length")
            for i, element in enumerate(value):
                self._write(collection["element"] or collection["member"], element, f"{path}[{i}]")
        elif kind == "string":
            text = value.encode() + b"\x00"
            self._write_number("I", len(text), f"{path}.length")
            self._body += text
        elif kind in _CODES:
            self._write_number(_CODES[kind], value, path)
        else:
            self._write_message(value, f"{path}.")

    def _write_number(self, code: str, value: Any, path: str) -> None:
        number = struct.pack(f"<{code}", value)
        self._body += bytes(-len(self._body) % len(number))
        self.places[path] = len(ENCAPSULATION) + len(self._body), code
        self._body += number


class Run(NamedTuple):
    """Run of numbers: first place in the frame, offset in the message, and how many."""

    place: int
    offset: int
    length: int


class MessageFormat:
    """Format of a message: a whole `template`, the places of its numbers, and their struct code.

    `mask` has all bits set where the template is constant.
    """

    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.message_class = message_class(topic.message_type)
        serialized = Serialized(empty_message(topic, self.message_class))
        self.template = serialized.bytes
        found = [serialized.places[path] for path in paths(topic)]
        self.code = found[0][1] if found else "d"
        offsets = [offset for offset, _ in found]
        self._where = frame.PLACES.get(topic.signal, slice(0, 0))
        self.runs = _runs(self._where.start, offsets, struct.calcsize(self.code))
        pieces = _pieces(len(self.template), offsets, self.code)
        order = [offset for offset, _ in pieces]
        variable = [
            order.index(STAMP_AT),
            order.index(STAMP_AT + 4),
            *(order.index(offset) for offset in offsets),
        ]
        constant = [piece for piece in range(len(pieces)) if piece not in variable]
        self._layout = struct.Struct("<" + "".join(code for _, code in pieces))
        self.mask = b"".join(
            (b"\xff" if code[-1] == "s" else b"\0") * struct.calcsize(code) for _, code in pieces
        )
        self._variable, self._constant = itemgetter(*variable), itemgetter(*constant)
        self._constants = self._constant(self._layout.unpack(self.template))
        # The constants and then stamp and numbers, brought into the order of the message.
        given = [*constant, *variable]
        self._in_message = itemgetter(*(given.index(piece) for piece in range(len(pieces))))

    def pack(self, stamp: int, here: frame.Frame) -> bytes:
        """The message with this stamp and the numbers of a frame, which must be finite."""
        given = (*self._constants, *divmod(stamp, stamps.NANOSECONDS), *here.numbers[self._where])
        return self._layout.pack(*self._in_message(given))

    def read(self, message: bytes) -> tuple[int, Sequence[float]]:
        """Stamp and numbers, by channel, of a message; MessageError if it is refused."""
        try:
            pieces = self._layout.unpack(message)
        except struct.error:
            return self._read_other_layout(message)
        if self._constant(pieces) != self._constants:
            return self._read_other_layout(message)
        seconds, nanoseconds, *numbers = self._variable(pieces)
        if not math.isfinite(sum(numbers)):  # or just large: their sum overflows
            self._refuse_not_finite(numbers)
        return seconds * stamps.NANOSECONDS + nanoseconds, self._without_sign(numbers)

    def _read_other_layout(self, message: bytes) -> tuple[int, Sequence[float]]:
        from rclpy.serialization import (
            deserialize_message,
        )  # a program that only writes needs no ROS

        try:
            stamp = stamp_of(message)
            read: Any = deserialize_message(message, self.message_class)
        except Exception as error:
            raise MessageError(
                f"{len(message)} bytes are no {self.topic.message_type}: {error}"
            ) from None
        numbers = numbers_in(self.topic, read)
        self._refuse_not_finite(numbers)
        return stamp, self._without_sign(numbers)

    def _refuse_not_finite(self, numbers: Sequence[float]) -> None:
        for channel, value in zip(self.topic.shape.channels, numbers, strict=True):
            if not math.isfinite(value):
                raise MessageError(f"{channel} is {value}, expected finite numbers")

    def _without_sign(self, numbers: Sequence[float]) -> Sequence[float]:
        shape = self.topic.shape
        if not shape.unsigned_commands:
            return numbers
        try:
            return shape.without_sign(numbers, shape.unsigned_commands)
        except SignalError as error:
            raise MessageError(str(error)) from None


def _pieces(size: int, offsets: list[int], code: str) -> list[tuple[int, str]]:
    """Offsets and struct codes of the pieces of a message: stamp, numbers, constant bytes."""
    variable = [
        (STAMP_AT, "i"),
        (STAMP_AT + 4, "I"),
        *((offset, code) for offset in sorted(offsets)),
    ]
    pieces, end = [], 0
    for offset, kind in variable:
        if offset > end:
            pieces.append((end, f"{offset - end}s"))
        pieces.append((offset, kind))
        end = offset + struct.calcsize(kind)
    return [*pieces, (end, f"{size - end}s")] if size > end else pieces


def _runs(place: int, offsets: list[int], size: int) -> tuple[Run, ...]:
    runs: list[Run] = []
    for i, offset in enumerate(offsets):
        last = runs[-1] if runs else None
        if last is not None and offset == last.offset + last.length * size:
            runs[-1] = last._replace(length=last.length + 1)
        else:
            runs.append(Run(place + i, offset, 1))
    return tuple(runs)


@cache
def format_of(signal: type) -> MessageFormat:
    """The format of the topic that carries a signal."""
    return MessageFormat(TOPICS[signal])


def stamp_of(message: bytes) -> int:
    """Stamp in a serialized message [ns]; MessageError if it is too short for one."""
    if len(message) < STAMP_AT + _STAMP.size or message[:2] != ENCAPSULATION[:2]:
        raise MessageError(
            f"{len(message)} bytes, beginning with {message[:STAMP_AT].hex()}, carry no stamp"
        )
    seconds: int
    nanoseconds: int
    seconds, nanoseconds = _STAMP.unpack_from(message, STAMP_AT)
    return seconds * stamps.NANOSECONDS + nanoseconds


def stamp_alone(stamp: int) -> bytes:
    """A serialized message that is nothing but a stamp, as /clock is."""
    return ENCAPSULATION + _STAMP.pack(*divmod(stamp, stamps.NANOSECONDS))
