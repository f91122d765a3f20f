"""Every topic through its real ROS message: nothing is lost, and what is wrong is refused in one clear line."""

from __future__ import annotations

import math
import struct
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from ev_msgs_py import cdr, stamps
from ev_msgs_py.codec import Codec, FieldCodec, Joints, JointStateCodec, MessageError
from ev_msgs_py.message_classes import message_class
from ev_msgs_py.roles import RECORDED, RECORDER_WRITES
from ev_msgs_py.shape import SignalError, shape_of
from ev_msgs_py.signals import BatteryCondition, BodyPose, DriverCommand, SteeringColumnState, WheelTorqueRequest
from ev_msgs_py.topics import TOPICS, Topic
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.wire_format import stamp_alone, stamp_of, wire_format
from ev_sim.recording.cdr_template import CdrTemplate

EVERY_TOPIC = pytest.mark.parametrize("topic", TOPICS.values(), ids=lambda topic: topic.name)
WITH_NUMBERS = pytest.mark.parametrize(
    "topic", [topic for topic in TOPICS.values() if topic.channels], ids=lambda topic: topic.name
)
SINGLE_MAX = float(np.finfo(np.float32).max)
# Bit patterns that tend to get lost: the sign of a zero, the smallest and the largest number, the last bit.
SPECIAL = (-0.0, 5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, math.nextafter(1.0, 2.0), 0.1)
finite = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(SPECIAL)
single = st.floats(-SINGLE_MAX, SINGLE_MAX) | st.sampled_from((-0.0, 5e-324, 1e-45, SINGLE_MAX, 0.1))
stamp_values = st.integers(0, (2**31 - 1) * stamps.NANOSECONDS)


@cache
def numbers_of(topic: Topic) -> st.SearchStrategy[tuple[float, ...]]:
    kind = single if topic.signal is BatteryCondition else finite
    return st.tuples(*[kind] * len(topic.channels))


def bits(values) -> bytes:
    """Equal bytes are equal bits: -0.0 differs from 0.0."""
    return struct.pack(f"<{len(values)}d", *values)


def message_of(topic: Topic, signal: object, stamp: int = 0) -> object:
    message = topic.codec.prepare(message_class(topic.codec.message_type)())
    header = getattr(message, "header", message)
    header.frame_id = topic.frame
    topic.codec.encode(signal, message)
    header.stamp.sec, header.stamp.nanosec = divmod(stamp, stamps.NANOSECONDS)
    return message


def over_the_wire(message: object) -> object:
    return deserialize_message(serialize_message(message), type(message))


def ordinary(topic: Topic) -> object:
    """A signal of different numbers, exact in single precision."""
    return topic.codec.shape.signal_of(tuple(0.5 + i for i in range(len(topic.channels))))


def one_line(error: pytest.ExceptionInfo) -> str:
    text = str(error.value)
    assert "\n" not in text
    assert len(text) < 250
    return text


# The table


def test_every_signal_that_a_role_or_the_recorder_writes_has_its_topic():
    assert set(TOPICS) == {*RECORDED, RECORDER_WRITES}


@EVERY_TOPIC
def test_every_field_has_a_unit_and_every_unit_a_field(topic):
    assert list(topic.units) == list(topic.signal._fields)
    assert all(topic.units.values())


def test_names_are_relative_and_channels_are_unique():
    """Relative, so that a scenario can put several cars side by side; a channel is a key of signals.npz."""
    names = [topic.name for topic in TOPICS.values()]
    channels = [channel for topic in TOPICS.values() for channel in topic.channels]
    assert not [name for name in names if name.startswith(("/", "~"))]
    assert len({*names}) == len(names)
    assert len({*channels}) == len(channels)
    assert "wheel_states.velocity.front_left" in channels
    assert "steering_column.state.angle" in channels


@EVERY_TOPIC
def test_only_the_agreed_message_packages_are_used(topic):
    """design.md: a stranger's node needs nothing but the messages that come with ROS."""
    assert topic.codec.message_type.split("/")[0] in ("std_msgs", "geometry_msgs", "sensor_msgs")
    assert hasattr(getattr(message_class(topic.codec.message_type)(), "header", None), "stamp") or topic.units == {}


def test_joints_are_named_by_their_wheel():
    """What `ros2 topic echo` shows: left before right, front before rear, brakes behind the drives."""
    message = message_of(TOPICS[WheelTorqueRequest], WheelTorqueRequest(Wheels(1.0, 2.0, 3.0, 4.0), Wheels.all(5.0)))
    assert message.name == [*WHEEL_NAMES, *(f"{wheel}_brake" for wheel in WHEEL_NAMES)]
    assert list(message.effort) == [1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0, 5.0]
    assert list(message.position) == list(message.velocity) == []


# There and back


@EVERY_TOPIC
@settings(max_examples=50)
@given(data=st.data())
def test_a_signal_comes_back_bit_for_bit(topic, data):
    """Through the real message and rclpy's serialization; what single precision cannot hold, `carried` rounds."""
    values = data.draw(numbers_of(topic))
    signal = topic.codec.shape.signal_of(values)
    carried = topic.codec.carried(signal)
    back = topic.codec.decode(over_the_wire(message_of(topic, signal)))
    assert type(back) is topic.signal
    assert bits(topic.codec.shape.flat(back)) == bits(topic.codec.shape.flat(carried))
    if topic.signal is not BatteryCondition:
        assert carried == signal
        assert bits(topic.codec.shape.flat(carried)) == bits(values)


@given(st.tuples(*[single] * 5))
def test_single_precision_rounds_to_nearest_and_only_once(values):
    """The independent opinion is numpy's float32; a signal that was carried before comes through unchanged."""
    codec = TOPICS[BatteryCondition].codec
    carried = codec.carried(BatteryCondition(*values))
    assert bits(codec.shape.flat(carried)) == bits(np.array(values).astype(np.float32).astype(float).tolist())
    assert codec.carried(carried) == carried


def assert_bytes_of_rclpy(packed: bytes, message: object) -> None:
    """The same bytes, but for padding between the fields and behind them: rclpy leaves it to chance, we write zeros."""
    theirs = serialize_message(message)
    assert 0 <= len(theirs) - len(packed) <= 8
    differing = [(ours, other) for ours, other in zip(packed, theirs, strict=False) if ours != other]
    assert all(ours == 0 for ours, _ in differing)
    assert len(differing) <= 3 * (1 + len(getattr(message, "name", ()))) + 7  # behind texts, before numbers
    assert deserialize_message(packed, type(message)) == message


@EVERY_TOPIC
@settings(max_examples=50)
@given(data=st.data())
def test_packing_gives_the_bytes_of_rclpy(topic, data):
    signal = topic.codec.shape.signal_of(data.draw(numbers_of(topic)))
    stamp = data.draw(stamp_values)
    packed = wire_format(topic.signal).pack(stamp, signal)
    assert_bytes_of_rclpy(packed, over_the_wire(message_of(topic, signal, stamp)))
    assert stamp_of(packed) == stamp
    back_stamp, back = wire_format(topic.signal).unpack(packed)
    assert back_stamp == stamp
    assert bits(topic.codec.shape.flat(back)) == bits(topic.codec.shape.flat(topic.codec.carried(signal)))


@EVERY_TOPIC
@settings(max_examples=25)
@given(data=st.data())
def test_signals_go_into_rows_of_numbers_and_come_back(topic, data):
    """A reader shows what its place holds at present, between the numbers of others."""
    shape = topic.codec.shape
    signals = [shape.signal_of(data.draw(numbers_of(topic))) for _ in range(3)]
    rows = np.zeros((3, shape.size))
    if shape.size:
        write = shape.writer(rows)
        for signal in signals:
            write(signal)
    assert [bits(row) for row in rows] == [bits(shape.flat(signal)) for signal in signals]
    place = np.full(shape.size + 4, 7.0)
    read = shape.reader(memoryview(place), 3)
    for signal, row in zip(signals, rows, strict=True):
        place[3 : 3 + shape.size] = row
        assert type(read()) is shape.signal
        assert bits(shape.flat(read())) == bits(shape.flat(signal))


@EVERY_TOPIC
def test_a_signal_of_too_few_numbers_is_none(topic):
    with pytest.raises(TypeError, match="numbers, not"):
        topic.codec.shape.signal_of((1.0,) * (topic.codec.shape.size + 1))


@EVERY_TOPIC
@settings(max_examples=25)
@given(data=st.data())
def test_a_whole_run_is_serialized_at_once_as_message_by_message(topic, data):
    rows = np.array(data.draw(st.lists(numbers_of(topic), min_size=1, max_size=4)), float)
    when = np.array([data.draw(stamp_values) for _ in rows])
    messages = CdrTemplate(topic).serialize(when, rows)
    signals = [topic.codec.shape.signal_of(tuple(row)) for row in rows.tolist()]
    pack = wire_format(topic.signal).pack
    assert messages == [pack(stamp, signal) for stamp, signal in zip(when.tolist(), signals, strict=True)]
    carried = [topic.codec.shape.flat(topic.codec.carried(signal)) for signal in signals]
    assert CdrTemplate(topic).numbers(messages).tobytes() == np.array(carried, float).tobytes()


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


# Other senders


@pytest.mark.parametrize(
    "topic", [t for t in TOPICS.values() if isinstance(t.codec, JointStateCodec)], ids=lambda topic: topic.name
)
@settings(max_examples=30)
@given(data=st.data())
def test_joints_in_another_order_mean_the_same(topic, data):
    """JointState is read by name; a sender in another language may list its joints as it likes."""
    signal = topic.codec.shape.signal_of(data.draw(numbers_of(topic)))
    ours = message_of(topic, signal, 7)
    order = data.draw(st.permutations(range(len(ours.name))))
    other = type(ours)(header=ours.header, name=[ours.name[i] for i in order])
    for kind in ("position", "velocity", "effort"):
        values = getattr(ours, kind)
        setattr(other, kind, [values[i] for i in order] if values else [])
    received = over_the_wire(other)
    assert topic.codec.decode(received) == signal
    assert received.name == [ours.name[i] for i in order]  # the message is read, not changed
    serialized = serialize_message(other)
    assert wire_format(topic.signal).unpack(serialized) == (7, signal)
    rows = CdrTemplate(topic).numbers([serialized, serialize_message(ours)])
    assert bits(rows[0]) == bits(rows[1])


@WITH_NUMBERS
def test_another_frame_name_and_further_content_are_read_too(topic):
    """They make the message longer, so that the numbers sit elsewhere; also when no message is laid out as ours."""
    signal = ordinary(topic)
    message = message_of(topic, signal, 5)
    message.header.frame_id = "somewhere/else"
    serialized = serialize_message(message)
    assert wire_format(topic.signal).unpack(serialized) == (5, signal)
    ours = wire_format(topic.signal).pack(5, signal)
    expected = np.array([topic.codec.shape.flat(signal)] * 2)
    assert (CdrTemplate(topic).numbers([serialized, ours]) == expected).all()
    assert (CdrTemplate(topic).numbers([serialized, serialized]) == expected).all()


def test_arrays_that_no_joint_uses_do_not_matter():
    topic = TOPICS[DriverCommand]
    message = message_of(topic, DriverCommand(1.0, 2.0, 3.0))
    message.position = [math.nan] * 3
    assert topic.codec.decode(over_the_wire(message)) == DriverCommand(1.0, 2.0, 3.0)


def test_a_layout_of_the_same_length_is_not_mistaken_for_ours():
    """The first joints of two messages exchanged: no byte count tells, only the names do."""
    topic = TOPICS[DriverCommand]
    message = message_of(topic, DriverCommand(1.0, 2.0, 3.0))
    message.name = ["brake", "drive", "steering_wheel"]
    serialized = cdr.serialize(message)
    assert len(serialized) == len(wire_format(DriverCommand).template)
    assert wire_format(DriverCommand).unpack(serialized)[1] == DriverCommand(2.0, 1.0, 3.0)


# Refused


JOINTS = TOPICS[SteeringColumnState]


def joint_message():
    return message_of(JOINTS, ordinary(JOINTS), 3)


def test_wrong_joint_names_are_refused_with_the_allowed_ones():
    message = joint_message()
    message.name = ["steering_wheel", "road_wheel"]
    with pytest.raises(MessageError) as error:
        JOINTS.codec.decode(over_the_wire(message))
    text = one_line(error)
    assert "'road_wheel'" in text
    assert "road_wheels" in text.partition("allowed")[2]


@pytest.mark.parametrize(
    "names", [[], ["steering_wheel"], ["steering_wheel"] * 2, ["steering_wheel", "road_wheels"] * 2]
)
def test_missing_and_repeated_joints_are_refused(names):
    message = joint_message()
    message.name = names
    with pytest.raises(MessageError, match="joint names are"):
        JOINTS.codec.decode(over_the_wire(message))


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
@pytest.mark.parametrize("count", [0, 1, 3])
def test_missing_and_additional_numbers_are_refused(order, count):
    """Also where the joints stand in another order."""
    message = joint_message()
    message.name = [message.name[i] for i in order]
    message.velocity = [0.0] * count
    with pytest.raises(MessageError) as error:
        JOINTS.codec.decode(over_the_wire(message))
    assert one_line(error) == f"velocity has {count} numbers, allowed are 2, one per joint"


@WITH_NUMBERS
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_wherever_it_stands(topic, bad):
    """Reading names the channel, writing names signal and channel; a packed message is no way around it."""
    codec = topic.codec
    good = codec.shape.flat(ordinary(topic))
    for i, channel in enumerate(codec.shape.channels):
        values = (*good[:i], bad, *good[i + 1 :])
        signal = codec.shape.signal_of(values)
        said = f"{topic.signal.__name__}.{channel} is {bad}"
        for refuse in (message_of, lambda topic, signal: wire_format(topic.signal).pack(0, signal)):
            with pytest.raises(SignalError) as error:
                refuse(topic, signal)
            assert one_line(error).startswith(said)
        if isinstance(codec, FieldCodec):
            with pytest.raises(SignalError):
                codec.numbers(signal)
        message = CdrTemplate(topic).serialize(np.zeros(1, int), np.array([values]))[0]
        for read in (wire_format(topic.signal).unpack, lambda message: CdrTemplate(topic).numbers([message])):
            with pytest.raises(MessageError) as error:
                read(message)
            assert one_line(error).startswith(f"{channel} is {bad}")


@given(st.tuples(*[finite] * 5))
def test_huge_finite_numbers_are_not_taken_for_infinite(values):
    """The quick look at the sum overflows for them."""
    huge = (1.7e308, 1.7e308, *values[2:])
    assert shape_of(SteeringColumnState).flat(SteeringColumnState(*huge)) == huge
    assert JOINTS.codec.signal_with(huge) == SteeringColumnState(*huge)


@pytest.mark.parametrize("voltage", [3.5e38, -1e300])
def test_what_single_precision_cannot_hold_is_refused(voltage):
    """Carried on, it would be infinite."""
    codec = TOPICS[BatteryCondition].codec
    signal = BatteryCondition(voltage, 1.0, 1.0, 1.0, 1.0)
    for refuse in (codec.carried, lambda signal: wire_format(BatteryCondition).pack(0, signal)):
        with pytest.raises(SignalError) as error:
            refuse(signal)
        assert one_line(error).startswith(f"BatteryCondition.voltage is {voltage}")
    with pytest.raises(SignalError):
        message_of(TOPICS[BatteryCondition], signal)


def test_largest_single_precision_numbers_may_come_together():
    codec = TOPICS[BatteryCondition].codec
    signal = BatteryCondition(*[SINGLE_MAX] * 5)
    assert codec.carried(signal) == signal


def test_a_codec_that_forgets_a_field_cannot_be_made():
    with pytest.raises(TypeError, match="no joint carries hand_torque"):
        JointStateCodec(DriverCommand, Joints(("drive",), "drive_torque"), Joints(("brake",), "brake_torque"))
    with pytest.raises(KeyError, match="capacity"):
        names = {name: name for name in ("voltage", "current", "charge")}
        FieldCodec(BatteryCondition, "sensor_msgs/msg/BatteryState", **names)


def test_imu_says_that_it_has_no_orientation():
    """sensor_msgs/Imu: a first covariance of -1 means that there is none."""
    topic = next(topic for topic in TOPICS.values() if topic.name == "imu")
    message = over_the_wire(message_of(topic, ordinary(topic)))
    assert message.orientation_covariance[0] == -1.0
    assert (message.linear_acceleration.z, message.angular_velocity.x) == (0.0, 0.0)


@given(st.floats(-math.pi, math.pi))
def test_heading_comes_back_from_the_quaternion(heading):
    """1e-15 is some rounding of an angle of the order of one; -pi and pi are the same heading."""
    pose = BodyPose.at(1.0, 2.0, heading)
    assert math.remainder(pose.heading - heading, math.tau) == pytest.approx(0.0, abs=2e-15)
    assert -math.pi <= pose.heading <= math.pi


def test_every_codec_is_used():
    """A codec without a topic would be tested by nobody."""
    used = {kind for topic in TOPICS.values() for kind in type(topic.codec).__mro__}
    assert {*Codec.__subclasses__(), *FieldCodec.__subclasses__()} <= used
