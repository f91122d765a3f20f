"""Values into bits and back."""

from __future__ import annotations

import math
import random
from types import SimpleNamespace
from typing import Any

import pytest
from can_bus.databases import ours
from can_bus.exact_bits import quantised
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ev_core.compiled.loop import compiled, one_record
from ev_msgs_py.can.database import _field
from ev_msgs_py.can.payload import BitField, byte_of, extracted, inserted
from ev_msgs_py.refusal import ParameterError

TORQUE = BitField(24.0, 16.0, 1.0, 0.03125, 32.0, 0.0, -1000.0, 1000.0)
TEMPERATURE = BitField(12.0, 9.0, 0.0, 0.5, 2.0, -40.0, -40.0, 215.0)


def test_a_negative_number_is_two_s_complement():
    """-1/32 N m is one step below zero: all bits set, in bytes 3 and 4 only."""
    payload = inserted(0, TORQUE, -0.03125)
    assert payload == 0xFFFF << 24
    assert extracted(payload, TORQUE) == -0.03125


def test_an_offset_is_taken_off_before_scaling():
    """20.5 degC above -40 degC in steps of 0.5 K."""
    assert inserted(0, TEMPERATURE, 20.5) == 121 << 12


def test_values_beyond_the_range_saturate():
    assert quantised(TORQUE, 1e300) == 1000.0
    assert quantised(TORQUE, -math.inf) == -1000.0


def test_values_are_rounded_to_the_nearest_step():
    assert quantised(TORQUE, 0.015) == 0.0
    assert quantised(TORQUE, 0.016) == 0.03125
    assert quantised(TORQUE, -0.016) == -0.03125


def test_what_has_been_quantised_once_stays_as_it_is():
    for frame in ours():
        for name, field in frame.signals.items():
            once = quantised(field, random.Random(name).uniform(field.low, field.high))
            assert quantised(field, once) == once


def test_byte_order_is_intel():
    frame = ours()["Drive11_SetPoint"]
    payload = frame.payload(dict.fromkeys(frame.signals, 0.0) | {"Torque": 100.0})
    data = frame.data(payload)
    assert int.from_bytes(data[3:5], "little") == 100 * 32
    assert list(data) == [byte_of(payload, place) for place in range(8)]


def test_what_is_no_number_is_refused_with_its_place():
    frame = ours()["Drive11_SetPoint"]
    with pytest.raises(
        ValueError, match=r"Drive11_SetPoint: Torque is nan, expected -1000 to 1000"
    ):
        frame.pack(dict.fromkeys(frame.signals, 0.0) | {"Torque": math.nan}, 0)


def test_names_that_are_missing_or_unknown_are_refused():
    frame = ours()["Drive11_SetPoint"]
    with pytest.raises(ValueError, match="missing or unknown: Drehmoment, Torque"):
        frame.pack({("Drehmoment" if n == "Torque" else n): 0.0 for n in frame.signals}, 0)


@settings(max_examples=200, derandomize=True, deadline=None)
@given(
    length=st.integers(1, 32),
    is_signed=st.booleans(),
    scale=st.floats(-9.0, 9.0).map(lambda power: 10.0**power),
    offset=st.sampled_from([0.0, -40.0, 1e9]) | st.floats(-1e9, 1e9),
    ends=st.tuples(*[st.floats(-0.1, 1.1) | st.sampled_from([0.0, 1.0])] * 2),
    value=st.floats(),
)
@example(length=16, is_signed=False, scale=1e-9, offset=1e9, ends=(0.0, 1.0), value=2e9)
def test_whatever_a_database_says_a_number_saturates_and_never_wraps(
    length, is_signed, scale, offset, ends, value
):
    """A range is refused, or each value arrives within half a step of the nearest end of it.

    NaN is no value.
    """
    least = -(1 << length - 1) if is_signed else 0
    first, last = offset + scale * least, offset + scale * (least + (1 << length) - 1)
    low, high = (first + share * (last - first) for share in sorted(ends))
    signal: Any = SimpleNamespace(
        name="Torque", byte_order="little_endian", length=length, is_float=False, minimum=low, maximum=high,
        scale=scale, offset=offset, is_signed=is_signed, start=0,
    )  # fmt: skip
    try:
        field = _field("Own", signal)
    except ParameterError as refused:
        assert "refused" in str(refused)
        return
    if math.isnan(value):
        with pytest.raises(ValueError, match="NaN"):
            inserted(0, field, value)
        return
    payload = inserted(0, field, value)
    arrived, digits = extracted(payload, field), 4e-16 * max(abs(first), abs(last))
    assert 0 <= payload < 1 << length
    assert abs(arrived - min(max(value, low), high)) <= 0.5001 * scale + digits
    assert arrived == quantised(field, value)


def test_a_counter_that_would_run_into_the_next_signal_is_refused():
    frame = ours()["Drive11_SetPoint"]
    with pytest.raises(
        ValueError, match="Drive11_SetPoint: counter 16 is refused, expected 0 to 14"
    ):
        frame.pack(dict.fromkeys(frame.signals, 0.0), 16)


def test_compiled_code_writes_and_reads_the_same_bits():
    write, read, step = compiled(inserted), compiled(extracted), compiled(quantised)
    numbers = random.Random(1)
    for field in (TORQUE, TEMPERATURE):
        there = one_record(field)[0]
        for _ in range(200):
            value = numbers.uniform(1.1 * field.low, 1.1 * field.high)
            payload = inserted(0, field, value)
            assert write(0, there, value) == payload
            assert read(payload, there) == extracted(payload, field)
            assert step(there, value) == quantised(field, value)
