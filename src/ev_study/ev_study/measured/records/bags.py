"""Numbers of the messages of a bag, of any type that the bag defines, and the channels that standard messages give.

How it works: a bag carries the definitions of its messages, so fields of any type can be read by
their names. All wanted columns of a topic share one list of times. A mapping names columns as
TOPIC:FIELD; without one `STANDARD` has, by type of message, the fields that measure a channel of
ours.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_core.parameters.data_file import MEGABYTE, SIGNALS, open_data
from ev_msgs_py.refusal import ParameterError, first_line, quoted, unknown_name
from ev_stack.recording.recording import refuse_unfinished
from ev_study.measured.records.record import (
    LATERAL,
    LATERAL_ACCELERATION,
    LONGITUDINAL,
    LONGITUDINAL_ACCELERATION,
    ROAD_WHEEL_ANGLE,
    YAW_RATE,
    Read,
)
from ev_study.measured.records.samples import Sampled

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

# By type of message what it measures, and in which field; all in SI, of a body frame as REP-103 has
# it.
STANDARD: Mapping[str, Mapping[str, str]] = {
    "sensor_msgs/msg/Imu": {
        YAW_RATE: "angular_velocity.z",
        LONGITUDINAL_ACCELERATION: "linear_acceleration.x",
        LATERAL_ACCELERATION: "linear_acceleration.y",
    },
    "geometry_msgs/msg/TwistStamped": {LONGITUDINAL: "twist.linear.x", LATERAL: "twist.linear.y"},
    "geometry_msgs/msg/TwistWithCovarianceStamped": {
        LONGITUDINAL: "twist.twist.linear.x",
        LATERAL: "twist.twist.linear.y",
    },
    "nav_msgs/msg/Odometry": {
        LONGITUDINAL: "twist.twist.linear.x",
        LATERAL: "twist.twist.linear.y",
    },
    "autoware_vehicle_msgs/msg/VelocityReport": {
        LONGITUDINAL: "longitudinal_velocity",
        LATERAL: "lateral_velocity",
    },
    "autoware_vehicle_msgs/msg/SteeringReport": {ROAD_WHEEL_ANGLE: "steering_tire_angle"},
    "ackermann_msgs/msg/AckermannDriveStamped": {ROAD_WHEEL_ANGLE: "drive.steering_angle"},
}
_ELEMENT = re.compile(r"(?P<array>[\w.]+)\[(?P<element>[^\]]+)\]")


def read_columns(bag: Path, wanted: Sequence[str]) -> Read:
    """The numbers TOPIC:FIELD over the stamps of the messages, or over when they came where they have none.

    FIELD has dots; [N] behind an array is its element, of a JointState [JOINT] that of a joint.
    There is no hash: a bag may be a folder. ParameterError, in one line, if the bag cannot be read
    or a column is not there.
    """
    by_topic = defaultdict(list)
    for column in wanted:
        topic, _, path = column.partition(":")
        by_topic[topic].append((column, path))
    with _opened(bag) as reader:
        topics = {each.topic for each in reader.connections}
        for topic in by_topic:
            if topic not in topics:
                raise ParameterError(f"{bag}: {unknown_name('topic', topic, sorted(topics))}")
        times: dict[str, list[float]] = defaultdict(list)
        values: dict[str, list[float]] = defaultdict(list)
        stamped, unstamped = Counter[str](), Counter[str]()
        for connection, came, data in reader.messages(
            [c for c in reader.connections if c.topic in by_topic]
        ):
            message = reader.deserialize(data, connection.msgtype)
            # The stamp is the time of measuring; that of recording has the delays of the network in
            # it.
            stamp = getattr(getattr(message, "header", None), "stamp", None)
            # A stamp of zero was never set by its driver.
            is_stamped = stamp is not None and (stamp.sec or stamp.nanosec)
            (stamped if is_stamped else unstamped)[connection.topic] += 1
            times[connection.topic].append(
                stamp.sec + 1e-9 * stamp.nanosec if is_stamped else 1e-9 * came
            )
            for column, path in by_topic[connection.topic]:
                values[column].append(_number(bag, message, column, path))
    columns = {}
    for topic, of in by_topic.items():
        for column, _ in of:
            columns[column] = Sampled(np.array(times[topic]), np.array(values[column]))
    # Where all count by when they were recorded it is one clock; beside stamps it is another one.
    late = unstamped.items() if stamped else ()
    notes = (
        f"{topic}: {count} messages without a stamp count by when they were recorded"
        for topic, count in late
    )
    return Read(columns, notes=tuple(notes))


def is_foreign(bag: Path) -> bool:
    """Return True if a bag has none of the wheel states that every run of ours has."""
    # No bag itself but the folder of a run of ours, or nothing: `find_recorded` looks into it.
    if bag.is_dir() and not (bag / "metadata.yaml").exists():
        return False
    with _opened(bag) as reader:
        return not any(each.topic.endswith("/wheel_states") for each in reader.connections)


def standard_channels(bag: Path) -> dict[str, str]:
    """Return by channel the column of the standard message that measures it.

    A velocity to the side that is zero throughout was not measured. ParameterError if one of those
    that an identification needs is missing, or if several topics give it.
    """
    found: dict[str, list[str]] = defaultdict(list)
    with _opened(bag) as reader:
        for each in sorted({(c.topic, c.msgtype) for c in reader.connections}):
            for channel, field in STANDARD.get(each[1], {}).items():
                found[channel].append(f"{each[0]}:{field}")
    if LATERAL in found:
        columns = read_columns(bag, found[LATERAL]).columns
        # Wheel odometry fills the field with zeros: a car without sideslip would be taken for
        # measured.
        found[LATERAL] = [name for name, each in columns.items() if np.any(each.values)]
    for channel in (YAW_RATE, LONGITUDINAL, ROAD_WHEEL_ANGLE):
        if not found[channel]:
            types = ", ".join(name for name, of in STANDARD.items() if channel in of)
            raise ParameterError(
                f"{bag} has no {channel}, expected {types}, or a mapping (--mapping)"
            )
    for channel, columns_of in found.items():
        if len(columns_of) > 1:
            raise ParameterError(
                f"{bag}: {channel} is any of {', '.join(columns_of)}: a mapping chooses (--mapping)"
            )
    return {channel: of[0] for channel, of in found.items() if of}


def _number(bag: Path, message: Any, column: str, path: str) -> float:
    """A field of a message, an element of an array in it, or that of a joint."""
    match = _ELEMENT.fullmatch(path)
    try:
        if match is None:
            return float(attrgetter(path)(message))
        array, element = attrgetter(match["array"])(message), match["element"]
        return float(
            # A JointState has the names of its joints beside the arrays of positions and efforts.
            array[int(element) if element.isdigit() else list(message.name).index(element)]
        )
    except (AttributeError, IndexError, TypeError, ValueError):
        raise ParameterError(
            f"{bag}: {quoted(column)} is no number of {type(message).__name__}"
        ) from None


@contextmanager
def _opened(bag: Path) -> Iterator[AnyReader]:
    """A bag that is open, which knows its messages by the definitions in it.

    Raises ParameterError for what is none.
    """
    if find_spec("rosbags") is None:
        raise ParameterError(f"{bag}: a bag needs the Python package rosbags, which is missing")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    # Names the command that mends the bag of a killed recorder; the library would only call it
    # broken.
    refuse_unfinished(bag)
    try:
        # Refuses a fifo, a device or a file that is too large before the library opens it.
        for file in (
            (each for each in bag.iterdir() if not each.is_dir()) if bag.is_dir() else [bag]
        ):
            open_data(file, SIGNALS).close()
        with AnyReader([bag], default_typestore=get_typestore(Stores.LATEST)) as reader:
            yield reader
    except ParameterError:
        raise
    except OSError as error:
        raise ParameterError(f"{bag}: {error.strerror or error}") from None
    except MemoryError:
        raise ParameterError(
            f"{bag}: unfolded it takes more memory than there is ({SIGNALS // MEGABYTE} MB packed)"
        ) from None
    # whatever the library and its decompressors raise for what is no bag
    except Exception as error:
        raise ParameterError(f"{bag}: the bag cannot be read: {first_line(error)}") from None
