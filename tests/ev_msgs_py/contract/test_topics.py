"""The declared signals.

Every field says its unit, its meaning and its place once, and the table is complete.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import Field, Shape, SignalError, shape_of
from ev_msgs_py.contract.roles import RECORDED, RECORDER_WRITES
from ev_msgs_py.contract.signals import BatteryCondition, BodyPose, SteeringColumnState
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.wire import message_class

EVERY_TOPIC = pytest.mark.parametrize("topic", TOPICS.values(), ids=lambda topic: topic.name)
SINGLE_MAX = float(np.finfo(np.float32).max)


def test_every_signal_that_a_role_or_the_recorder_writes_has_its_topic():
    assert set(TOPICS) == {*RECORDED, RECORDER_WRITES}


@EVERY_TOPIC
def test_every_field_has_a_unit_a_meaning_and_a_place_of_its_own(topic):
    fields = topic.shape.fields
    assert list(fields) == list(topic.signal._fields)
    assert all(field.unit and field.about and field.place for field in fields.values())
    assert len({field.place for field in fields.values()}) == len(fields)


def test_fields_of_one_sensor_share_unit_and_scale():
    """One sensor measures them, so its parameters have one unit and one range."""
    sensors: dict[str, set] = {}
    for topic in TOPICS.values():
        for field in topic.shape.fields.values():
            if field.sensor and field.sensor not in ("body_heading", "battery_state_of_charge"):
                sensors.setdefault(field.sensor, set()).add((field.unit, field.largest, topic.name))
    assert all(len(properties) == 1 for properties in sensors.values())
    assert len(sensors) > 20


def test_a_signal_with_an_undescribed_field_cannot_be_declared():
    class Bare(NamedTuple):
        speed: float

    class Mixed(NamedTuple):
        speed: Annotated[float, Field("m/s", "of the car", "speed")]
        torque: Annotated[Wheels, Field("N m", "at the wheel", "{wheel}.effort")]

    with pytest.raises(TypeError, match="has nothing about unit"):
        Shape(Bare)
    with pytest.raises(TypeError, match="mixes numbers and values per wheel"):
        Shape(Mixed)


def test_names_are_relative_and_channels_are_unique():
    """Relative, so that a scenario can put several cars side by side.

    A channel is a key of signals.npz.
    """
    names = [topic.name for topic in TOPICS.values()]
    channels = [channel for topic in TOPICS.values() for channel in topic.channels]
    assert not [name for name in names if name.startswith(("/", "~"))]
    assert len({*names}) == len(names)
    assert len({*channels}) == len(channels)
    assert "wheel_states.velocity.front_left" in channels
    assert "steering_column.state.angle" in channels


def test_the_frame_holds_every_number_of_every_role_once():
    """Time first, then the signals one behind the other without a gap."""
    places = [frame.TIME, *(place for signal in RECORDED for place in frame.places(signal))]
    assert places == list(range(frame.SIZE))


@EVERY_TOPIC
def test_only_the_agreed_message_packages_are_used(topic):
    """A stranger's node needs nothing but the messages that come with ROS."""
    assert topic.message_type.split("/")[0] in ("std_msgs", "geometry_msgs", "sensor_msgs")
    message = message_class(topic.message_type)()
    assert hasattr(getattr(message, "header", None), "stamp") or not topic.channels


@EVERY_TOPIC
def test_a_signal_of_too_few_numbers_is_none(topic):
    with pytest.raises(TypeError, match="numbers, not"):
        topic.shape.signal_of((1.0,) * (topic.shape.size + 1))


@given(
    st.tuples(
        *[
            st.floats(-SINGLE_MAX, SINGLE_MAX)
            | st.sampled_from((-0.0, 5e-324, 1e-45, SINGLE_MAX, 0.1))
        ]
        * 5
    )
)
def test_single_precision_rounds_to_nearest_and_only_once(values):
    """The independent opinion is numpy's float32.

    A signal that was carried before comes through unchanged.
    """
    shape = shape_of(BatteryCondition)
    carried = shape.carried(values)
    assert (
        np.array(carried).tobytes() == np.array(values).astype(np.float32).astype(float).tobytes()
    )
    assert shape.carried(carried) == carried


@pytest.mark.parametrize("voltage", [3.5e38, -1e300])
def test_what_single_precision_cannot_hold_is_refused(voltage):
    """Carried on, it would be infinite."""
    with pytest.raises(
        SignalError, match=f"BatteryCondition.voltage is {voltage}".replace("+", r"\+")
    ):
        shape_of(BatteryCondition).refuse_not_finite((voltage, 1.0, 1.0, 1.0, 1.0))


def test_huge_finite_numbers_are_not_refused():
    """A quick look at their sum would take them for infinite."""
    shape_of(SteeringColumnState).refuse_not_finite((1.7e308,) * 5)
    shape_of(BatteryCondition).refuse_not_finite((SINGLE_MAX,) * 5)


@given(st.floats(-math.pi, math.pi))
def test_heading_comes_back_from_the_quaternion(heading):
    """1e-15 is some rounding of an angle of the order of one; -pi and pi are the same heading."""
    pose = BodyPose.at(1.0, 2.0, heading)
    assert math.remainder(pose.heading - heading, math.tau) == pytest.approx(0.0, abs=2e-15)
    assert -math.pi <= pose.heading <= math.pi
