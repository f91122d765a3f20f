"""Every topic through its real ROS message.

Nothing is lost, and what is wrong is refused in one clear line.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import NEGLIGIBLE
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.optional_signals import CellCondition
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    DriverCommand,
    SteeringColumnState,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.topics import JOINT_STATE, TOPICS, Topic
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire import (
    MessageError,
    Serialized,
    empty_message,
    format_of,
    message_class,
    paths,
    stamp_alone,
    stamp_of,
)
from ev_nodes.node_loop.steps import (
    RUN,
    TOPIC,
    Memory,
    is_laid_out_like,
    read_numbers,
    stamp_in,
    write_message,
)
from ev_stack.recording.spool import MessageTable

WITH_NUMBERS = pytest.mark.parametrize(
    "topic", [topic for topic in TOPICS.values() if topic.channels], ids=lambda topic: topic.name
)
JOINTS = pytest.mark.parametrize(
    "topic",
    [topic for topic in TOPICS.values() if topic.message_type == JOINT_STATE],
    ids=lambda topic: topic.name,
)
SINGLE_MAX = float(np.finfo(np.float32).max)
SINGLE = (BatteryCondition, CellCondition)  # signals in single precision
# Bit patterns that tend to get lost: the sign of a zero, the smallest and the largest number, the
# last bit.
SPECIAL = (
    -0.0,
    5e-324,
    -2.2250738585072014e-308,
    1.7976931348623157e308,
    math.nextafter(1.0, 2.0),
    0.1,
)
finite = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(SPECIAL)
single = st.floats(-SINGLE_MAX, SINGLE_MAX, width=32) | st.sampled_from((-0.0, SINGLE_MAX, 0.5))
stamp_values = st.integers(0, (2**31 - 1) * stamps.NANOSECONDS)


@cache
def numbers_of(topic: Topic) -> st.SearchStrategy[tuple[float, ...]]:
    kind = single if topic.signal in SINGLE else finite
    unsigned = topic.shape.unsigned_commands
    return st.tuples(
        *(kind.map(abs) if i in unsigned else kind for i in range(len(topic.channels)))
    )


def ordinary(topic: Topic) -> list[float]:
    """Different numbers, exact in single precision."""
    return [0.5 + i for i in range(len(topic.channels))]


def framed(topic: Topic, numbers) -> Frame:
    here = Frame()
    here.numbers[frame.PLACES[topic.signal]] = frame.numbers_of(list(numbers))
    return here


def packed(topic: Topic, numbers, stamp: int = 0) -> bytes:
    return format_of(topic.signal).pack(stamp, framed(topic, numbers))


def message_of(topic: Topic, numbers, stamp: int = 0) -> object:
    """The message as a stranger would fill it: attribute by attribute, by the declared paths."""
    message = empty_message(topic, message_class(topic.message_type))
    for path, value in zip(paths(topic), numbers, strict=True):
        if "[" in path:
            kind, _, place = path.rstrip("]").partition("[")
            getattr(message, kind)[int(place)] = value
        else:
            *parents, leaf = path.split(".")
            target = message
            for name in parents:
                target = getattr(target, name)
            setattr(target, leaf, value)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, stamps.NANOSECONDS)
    return message


def read(topic: Topic, message: bytes) -> bytes:
    """The bits of the numbers in a serialized message."""
    return bits(format_of(topic.signal).read(message)[1])


def bits(values) -> bytes:
    """Equal bytes are equal bits: -0.0 differs from 0.0."""
    return np.array(list(values), float).tobytes()


def refusal(topic: Topic, message: bytes) -> str:
    with pytest.raises(MessageError) as error:
        format_of(topic.signal).read(message)
    text = str(error.value)
    assert "\n" not in text
    assert len(text) < 250
    return text


# There and back


@WITH_NUMBERS
@settings(max_examples=20)
@given(data=st.data())
def test_numbers_come_back_bit_for_bit(topic, data):
    """Packed by us, and filled and serialized by rclpy as a stranger would."""
    values, stamp = data.draw(numbers_of(topic)), data.draw(stamp_values)
    for message in (
        packed(topic, values, stamp),
        serialize_message(message_of(topic, values, stamp)),
    ):
        assert read(topic, message) == bits(values)
        assert stamp_of(message) == stamp


@WITH_NUMBERS
@settings(max_examples=20)
@given(data=st.data())
def test_packing_gives_the_bytes_of_rclpy(topic, data):
    """The same bytes, but for padding between the fields and behind them.

    Rclpy leaves it to chance, we write zeros.
    """
    values, stamp = data.draw(numbers_of(topic)), data.draw(stamp_values)
    ours, message = packed(topic, values, stamp), message_of(topic, values, stamp)
    theirs = serialize_message(message)
    # To the estimated size rclpy adds up to 4 bytes of padding for each array of doubles, also
    # where that is empty.
    empty = sum(
        len(getattr(message, name, "-")) == 0 for name in ("position", "velocity", "effort")
    )
    assert 0 <= len(theirs) - len(ours) <= max(8, 4 + 4 * empty)
    differing = [(one, other) for one, other in zip(ours, theirs, strict=False) if one != other]
    assert all(one == 0 for one, _ in differing)
    # behind texts, before numbers
    assert len(differing) <= 3 * (1 + len(getattr(message, "name", ()))) + 7
    assert deserialize_message(ours, type(message)) == message


def test_the_recorders_progress_is_nothing_but_its_stamp():
    topic = next(topic for topic in TOPICS.values() if not topic.channels)
    message = format_of(topic.signal).pack(5_000_000_001, Frame())
    header = deserialize_message(message, message_class(topic.message_type))
    assert stamps.read(header.stamp) == stamp_of(message) == 5_000_000_001
    assert format_of(topic.signal).read(message) == (5_000_000_001, [])


@pytest.mark.sampled
@WITH_NUMBERS
@settings(max_examples=20)
@given(data=st.data())
def test_a_whole_run_is_serialized_at_once_as_message_by_message(topic, data):
    rows = data.draw(st.lists(numbers_of(topic), min_size=1, max_size=4))
    when = np.array([data.draw(stamp_values) for _ in rows])
    frames = np.array([framed(topic, row).numbers.tolist() for row in rows])
    messages = MessageTable(topic).serialize(when, frames)
    assert messages == [
        packed(topic, row, stamp) for stamp, row in zip(when.tolist(), rows, strict=True)
    ]
    back = np.zeros_like(frames)
    MessageTable(topic).read(messages, back)
    assert back.tobytes() == frames.tobytes()


@given(st.integers(0, 10**18))
@example(999_999_999)
@example(1_000_000_000)
def test_stamps_are_whole_nanoseconds(stamp):
    """2**31 s are what builtin_interfaces/Time can say, and more than any run lasts."""
    clock = deserialize_message(stamp_alone(stamp), message_class("rosgraph_msgs/msg/Clock")).clock
    assert 0 <= clock.nanosec < 10**9
    assert stamps.read(clock) == stamp
    assert stamp_of(stamp_alone(stamp)) == stamp


@given(st.integers(0, 10**7), st.sampled_from((0.01, 0.001, 0.0001, 0.005)))
def test_seconds_of_a_step_lead_back_to_its_stamp(step, period):
    """Up to 1e5 s a float of seconds is exact to better than a nanosecond."""
    stamp = step * stamps.from_seconds(period)
    assert stamps.from_seconds(stamps.to_seconds(stamp)) == stamp


def test_joints_are_named_by_their_wheel():
    """`ros2 topic echo` shows left before right, front before rear, brakes behind the drives."""
    topic = TOPICS[WheelTorqueRequest]
    message = deserialize_message(
        packed(topic, (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)), message_class(JOINT_STATE)
    )
    assert message.name == [*WHEEL_NAMES, *(f"{wheel}_brake" for wheel in WHEEL_NAMES)]
    assert list(message.effort) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]
    assert list(message.position) == list(message.velocity) == []


def test_imu_says_that_it_has_no_orientation():
    """sensor_msgs/Imu: a first covariance of -1 means that there is none."""
    topic = next(topic for topic in TOPICS.values() if topic.name == "imu")
    message = deserialize_message(packed(topic, ordinary(topic)), message_class(topic.message_type))
    assert message.orientation_covariance[0] == -1.0
    assert (message.linear_acceleration.z, message.angular_velocity.x) == (0.0, 0.0)


# Other senders


@JOINTS
@settings(max_examples=20)
@given(data=st.data())
def test_joints_in_another_order_mean_the_same(topic, data):
    """JointState is read by name; a sender in another language may list its joints as it likes."""
    values = data.draw(numbers_of(topic))
    ours = message_of(topic, values, 7)
    order = data.draw(st.permutations(range(len(ours.name))))
    other = type(ours)(header=ours.header, name=[ours.name[i] for i in order])
    for kind in ("position", "velocity", "effort"):
        numbers = getattr(ours, kind)
        setattr(other, kind, [numbers[i] for i in order] if numbers else [])
    serialized = serialize_message(other)
    assert read(topic, serialized) == bits(values)
    assert format_of(topic.signal).read(serialized)[0] == 7
    frames = np.zeros((2, frame.SIZE))
    MessageTable(topic).read([serialized, serialize_message(ours)], frames)
    assert frames[0].tobytes() == frames[1].tobytes()


@WITH_NUMBERS
def test_without_a_frame_name_it_is_read_and_of_another_frame_refused(topic):
    """A message without a frame name is shorter, and its numbers sit elsewhere.

    It is read also when no message has our layout.
    """
    values = ordinary(topic)
    message = message_of(topic, values, 5)
    message.header.frame_id = "somewhere/else"
    assert refusal(topic, serialize_message(message)).startswith(
        "frame_id is 'somewhere/else', expected "
    )
    message.header.frame_id = ""
    serialized = serialize_message(message)
    assert read(topic, serialized) == bits(values)
    for messages in ([serialized, packed(topic, values, 5)], [serialized, serialized]):
        frames = np.zeros((2, frame.SIZE))
        MessageTable(topic).read(messages, frames)
        assert (frames[:, frame.PLACES[topic.signal]] == values).all()


def test_arrays_that_no_joint_uses_do_not_matter():
    topic = TOPICS[DriverCommand]
    message = message_of(topic, (1.0, 2.0, 3.0))
    message.position = [math.nan] * 3
    assert read(topic, serialize_message(message)) == bits((1.0, 2.0, 3.0))


def test_a_layout_of_the_same_length_is_not_mistaken_for_ours():
    """The first joints of two messages exchanged: no byte count tells, only the names do."""
    topic = TOPICS[DriverCommand]
    message = message_of(topic, (1.0, 2.0, 3.0))
    message.name = ["brake", "drive", "steering_wheel"]
    serialized = Serialized(message).bytes
    assert len(serialized) == len(format_of(DriverCommand).template)
    assert read(topic, serialized) == bits((2.0, 1.0, 3.0))


# Refused

COLUMN = TOPICS[SteeringColumnState]


def column_message():
    return message_of(COLUMN, ordinary(COLUMN), 3)


def test_wrong_joint_names_are_refused_with_the_allowed_ones():
    message = column_message()
    message.name = ["steering_wheel", "road_wheel"]
    text = refusal(COLUMN, serialize_message(message))
    assert "'road_wheel'" in text
    assert "road_wheels" in text.partition("expected")[2]


@pytest.mark.parametrize(
    "names", [[], ["steering_wheel"], ["steering_wheel"] * 2, ["steering_wheel", "road_wheels"] * 2]
)
def test_missing_and_repeated_joints_are_refused(names):
    message = column_message()
    message.name = names
    assert refusal(COLUMN, serialize_message(message)).startswith("joint names are")


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
@pytest.mark.parametrize("count", [0, 1, 3])
def test_missing_and_additional_numbers_are_refused(order, count):
    """Joints in another order are refused in the same words."""
    message = column_message()
    message.name = [message.name[i] for i in order]
    message.velocity = [0.0] * count
    text = refusal(COLUMN, serialize_message(message))
    assert text == f"velocity has {count} numbers, expected 2, one per joint"


@WITH_NUMBERS
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_wherever_it_stands(topic, bad):
    good = ordinary(topic)
    for i, channel in enumerate(topic.shape.channels):
        message = packed(topic, [*good[:i], bad, *good[i + 1 :]])
        assert refusal(topic, message).startswith(f"{channel} is {bad}")
        with pytest.raises(MessageError, match=f"{channel} is {bad}"):
            MessageTable(topic).read([message], np.zeros((1, frame.SIZE)))


@WITH_NUMBERS
@given(number=finite | st.floats(-2.0 * NEGLIGIBLE, 0.0))
def test_a_negative_command_is_refused_where_it_has_no_sign(topic, number):
    """Leftovers of rounding are 0; a measured value may be negative by its noise."""
    good = ordinary(topic)
    for i in topic.shape.never_negative if topic.signal not in SINGLE else ():
        is_command = i in topic.shape.unsigned_commands
        message = packed(topic, [*good[:i], number, *good[i + 1 :]])
        table = np.zeros((1, frame.SIZE))
        if is_command and number < -NEGLIGIBLE:
            refused = refusal(topic, message)
            assert (
                refused
                == f"{topic.signal.__name__}.{topic.shape.channels[i]} is {number}, expected 0 or more"
            )
            with pytest.raises(MessageError, match="expected 0 or more"):
                MessageTable(topic).read([message], table)
            continue
        expected = bits([*good[:i], 0.0 if is_command and number < 0.0 else number, *good[i + 1 :]])
        assert read(topic, message) == expected
        MessageTable(topic).read([message], table)
        assert bits(table[0, frame.PLACES[topic.signal]]) == expected


@WITH_NUMBERS
def test_huge_finite_numbers_are_not_taken_for_infinite(topic):
    """The quick look at the sum overflows for them."""
    huge = [SINGLE_MAX if topic.signal in SINGLE else 1.7e308] * len(topic.channels)
    assert read(topic, packed(topic, huge)) == bits(huge)


@WITH_NUMBERS
@settings(max_examples=30)
@given(data=st.data())
def test_what_cannot_be_read_is_refused_in_one_line(topic, data):
    """Cut off, prolonged, with other bytes in it or big-endian.

    A node must survive whatever a stranger sends.
    """
    message = bytearray(packed(topic, ordinary(topic)))
    cut = data.draw(st.integers(0, len(message)))
    spoilt = bytes(message[:cut]) + data.draw(st.binary(max_size=40))
    try:
        format_of(topic.signal).read(spoilt)
    except MessageError as error:
        assert "\n" not in str(error)


def test_garbage_carries_no_stamp():
    for garbage in (b"", b"\x00\x01\x00\x00", b"\x00\x00\x00\x00" + bytes(40), b"\xff" * 60):
        with pytest.raises(MessageError, match="carry no stamp"):
            stamp_of(garbage)


@pytest.mark.sampled
@WITH_NUMBERS
def test_compiled_code_reads_and_writes_the_same_bytes(topic):
    """Numbers and stamp are read and written, other messages refused, in a block of memory.

    Here the code runs as plain Python.
    """
    of, block = format_of(topic.signal), np.zeros(2048, np.int64)
    memory = Memory(
        *(block.view(kind) for kind in (np.uint8, np.int64, np.int32, np.float64, np.float32))
    )
    there = np.zeros(1, np.dtype(TOPIC)).view(np.recarray)[0]
    # numbers stand at whole ones behind the four bytes of encapsulation
    there.template, there.mask, at = 4, 4100, 8196
    there.length, there.last, there.single = len(of.template), len(of.runs), of.code == "f"
    memory.bytes[there.template : there.template + len(of.template)] = list(of.template)
    memory.bytes[there.mask : there.mask + len(of.mask)] = list(of.mask)
    runs = np.array([tuple(run) for run in of.runs], RUN).view(np.recarray)
    stamp, given = 12_345_678_901, framed(topic, ordinary(topic))
    write_message(memory, there, runs, stamp, given.numbers)
    message = bytes(memory.bytes[there.template : there.template + len(of.template)])
    assert message == of.pack(stamp, given)
    memory.bytes[at : at + len(message)] = list(message)
    found = Frame()
    assert is_laid_out_like(memory, at, there)
    assert read_numbers(memory, at, there, runs, found.numbers)
    assert stamp_in(memory, at) == stamp
    assert bytes(found.numbers) == bytes(given.numbers)
    constants = [n for n, constant in enumerate(of.mask) if constant]
    # evenly spread: each takes a look at all bytes
    for place in constants[:: max(len(constants) // 50, 1)]:
        memory.bytes[at + place] ^= 1
        assert not is_laid_out_like(memory, at, there)
        memory.bytes[at + place] ^= 1
    last = of.runs[-1]
    numbers = memory.singles if there.single else memory.doubles
    for wrong in (math.nan, math.inf, -math.inf):
        numbers[(at + last.offset) // numbers.itemsize + last.length - 1] = wrong
        with np.errstate(invalid="ignore"):  # numpy warns of what is asked for
            assert not read_numbers(memory, at, there, runs, found.numbers)
