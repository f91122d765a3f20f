"""Signals to ROS messages and back, declared per topic and without loss of a single bit.

A codec knows messages by their attributes only, so this module needs no ROS. Encoders reuse one message object.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter, itemgetter
from typing import Any

from ev_msgs_py.shape import Shape, SignalError, shape_of
from ev_msgs_py.wheels import WHEEL_NAMES


class MessageError(ValueError):
    """A message was refused; the text says what, the value, and what is allowed."""


class Codec(ABC):
    """Conversion between one signal type and one message type."""

    message_type: str
    shape: Shape
    rounds = False  # whether the message carries single precision

    @abstractmethod
    def prepare(self, message: Any) -> Any:
        """Fill the constant parts of a fresh message and return it."""

    @abstractmethod
    def encode(self, signal: Any, message: Any) -> None:
        """Write the numbers of a signal into a prepared message; SignalError if one is not finite."""

    @abstractmethod
    def decode(self, message: Any) -> Any:
        """The signal in a message; MessageError if names are wrong, numbers are missing or not finite."""

    def numbers(self, signal: Any) -> Sequence[float]:
        """The numbers that the message carries, in order of the channels; SignalError if one is not finite."""
        return self.shape.flat(signal)

    def carried(self, signal: Any) -> Any:
        """The signal as it arrives at the other end: the same, unless the message carries single precision."""
        return signal

    def signal_with(self, values: Sequence[float]) -> Any:
        """The signal with these numbers in order of the channels; MessageError if one is not finite."""
        if not math.isfinite(sum(values)):
            for channel, value in zip(self.shape.channels, values, strict=True):
                if not math.isfinite(value):
                    raise MessageError(f"{channel} is {value}, allowed are finite numbers")
        return self.shape.signal_of(tuple(values))


@dataclass(frozen=True, slots=True)
class Joints:
    """Some joints of a JointState and the fields of the signal that their position, velocity and effort carry.

    A field per wheel needs the four wheel joints, a field that is one number a single joint. What no field is given
    for is zero.
    """

    names: tuple[str, ...]
    position: str | None = None
    velocity: str | None = None
    effort: str | None = None


_ARRAYS = ("position", "velocity", "effort")


class JointStateCodec(Codec):
    """A signal as sensor_msgs/JointState: joints by name, values in position, velocity and effort.

    An array that no joint uses stays empty, as JointState asks for.
    """

    message_type = "sensor_msgs/msg/JointState"

    def __init__(self, signal: type, *joints: Joints) -> None:
        self.shape = shape_of(signal)
        self.names = [name for group in joints for name in group.names]
        index = {channel: i for i, channel in enumerate(self.shape.channels)}
        zero = len(index)  # index of the extra number that fills unused places
        self._rows = []
        for kind in _ARRAYS:
            row: list[int] = []
            for group in joints:
                field = getattr(group, kind)
                if field is None:
                    row += [zero] * len(group.names)
                elif self.shape.per_wheel:
                    row += [index[f"{field}.{wheel}"] for wheel in WHEEL_NAMES]
                else:
                    row.append(index[field])
            if any(i != zero for i in row):
                self._rows.append((kind, itemgetter(*row, zero)))
        places = [i for _, get in self._rows for i in get(range(zero + 1))[:-1]]
        missing = [channel for channel, i in index.items() if i not in places]
        if missing:
            raise TypeError(f"{signal.__name__}: no joint carries {', '.join(missing)}")
        self._gather = itemgetter(*(places.index(i) for i in range(zero)))

    def prepare(self, message: Any) -> Any:
        message.name = list(self.names)
        return message

    def encode(self, signal: Any, message: Any) -> None:
        numbers = (*self.shape.flat(signal), 0.0)
        for kind, get in self._rows:
            setattr(message, kind, array("d", get(numbers)[:-1]))

    def decode(self, message: Any) -> Any:
        if message.name == self.names:
            arrays = [getattr(message, kind) for kind, _ in self._rows]
            wrong = [kind for (kind, _), a in zip(self._rows, arrays, strict=True) if len(a) != len(self.names)]
            if wrong:
                count = len(getattr(message, wrong[0]))
                raise MessageError(f"{wrong[0]} has {count} numbers, allowed are {len(self.names)}, one per joint")
            return self.signal_with(self._gather([value for a in arrays for value in a]))
        return self.decode(self._reordered(message))

    def _reordered(self, message: Any) -> Any:
        """The same message with its joints in our order, for senders that list them in another one."""
        if sorted(message.name) != sorted(self.names):
            raise MessageError(f"joint names are {list(message.name)}, allowed are {self.names}")
        order = [list(message.name).index(name) for name in self.names]
        ordered = type(message)()
        ordered.name = list(self.names)
        for kind, _ in self._rows:
            values = getattr(message, kind)
            if len(values) != len(order):
                raise MessageError(f"{kind} has {len(values)} numbers, allowed are {len(order)}, one per joint")
            setattr(ordered, kind, array("d", [values[i] for i in order]))
        return ordered


class FieldCodec(Codec):
    """A signal whose numbers sit in named places of a message, such as Imu, TwistStamped or BatteryState."""

    def __init__(self, signal: type, message_type: str, *, single_precision: bool = False, **places: str) -> None:
        self.message_type = message_type
        self.shape = shape_of(signal)
        self._places = [places[channel] for channel in self.shape.channels]
        self._get = attrgetter(*self._places)
        self.rounds = single_precision

    def prepare(self, message: Any) -> Any:
        return message

    def encode(self, signal: Any, message: Any) -> None:
        for place, value in zip(self._places, self.numbers(signal), strict=True):
            parent, _, leaf = place.rpartition(".")
            setattr(attrgetter(parent)(message) if parent else message, leaf, value)

    def decode(self, message: Any) -> Any:
        return self.signal_with(self._get(message))

    def numbers(self, signal: Any) -> Sequence[float]:
        values = self.shape.flat(signal)
        if not self.rounds:
            return values
        single = array("f", values)
        if not math.isfinite(sum(single)):
            self._refuse_overflow(values, single)
        return single

    def _refuse_overflow(self, values: Sequence[float], single: Sequence[float]) -> None:
        for channel, value, carried in zip(self.shape.channels, values, single, strict=True):
            if not math.isfinite(carried):
                name = f"{self.shape.signal.__name__}.{channel}"
                raise SignalError(f"{name} is {value}, allowed is what single precision holds, up to 3.4e38")

    def carried(self, signal: Any) -> Any:
        if not self.rounds:
            return signal
        single = self.numbers(signal)
        return signal if tuple(single) == signal else self.shape.signal_of(single)


class ImuCodec(FieldCodec):
    """sensor_msgs/Imu of a sensor without orientation (first covariance -1, as Imu asks for)."""

    def prepare(self, message: Any) -> Any:
        message.orientation_covariance[0] = -1.0
        return message


class StampCodec(Codec):
    """A signal that is nothing but its stamp, as std_msgs/Header."""

    message_type = "std_msgs/msg/Header"

    def __init__(self, signal: type) -> None:
        self.shape = shape_of(signal)

    def prepare(self, message: Any) -> Any:
        return message

    def encode(self, signal: Any, message: Any) -> None:
        """Nothing to write: the stamp is set where the message is published."""

    def decode(self, message: Any) -> Any:
        return self.shape.signal()
