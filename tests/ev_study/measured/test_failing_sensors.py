"""Sensors that fail in a drive and clocks that are set back.

What is wrong is masked, and no window leads across.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_study.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    measured,
)
from ev_study.measured.records.samples import Sampled
from ev_study.measured.replays.open_loop import windows_of

PERIOD, SAMPLES = 0.01, 600
TIME = PERIOD * np.arange(SAMPLES)
TRUTH = {
    LONGITUDINAL: 20.0 + np.sin(TIME),
    LATERAL: 0.3 * np.sin(2.0 * TIME),
    YAW_RATE: 0.4 * np.sin(2.0 * TIME),
    ROAD_WHEEL_ANGLE: 0.06 * np.sin(2.0 * TIME),
}
NOISE = 0.01
SHORTEST = 0.2  # [s] of a window


def record_of(columns: dict[str, np.ndarray], time: np.ndarray = TIME) -> MeasuredRecord:
    sampled = {
        name: (Sampled(time, values), ColumnParameters()) for name, values in columns.items()
    }
    return measured("made", "", sampled, MaskParameters())


# By channel a level that the sensor may show instead: farther off than any step of a car, 3.3 m/s
# and 1.2 rad/s.
FAILED = [
    (LONGITUDINAL, 0.0),
    (LONGITUDINAL, 182.0),
    (LATERAL, 20.0),
    (YAW_RATE, 5.0),
    (ROAD_WHEEL_ANGLE, -0.4),
]


@settings(deadline=None, max_examples=200)
@given(
    failed=st.sampled_from(FAILED),
    begin=st.integers(20, 300),
    length=st.integers(1, 250),
    empty=st.tuples(st.integers(0, 4), st.integers(0, 4)),
    seed=st.integers(0, 99),
)
def test_no_number_of_a_sensor_that_fails_for_a_while_is_believed(
    failed, begin, length, empty, seed
):
    """It is off for up to half of the record, with cells without a number around that."""
    channel, level = failed
    end = begin + length
    values = TRUTH[channel] + 0.1 * NOISE * np.random.Generator(
        np.random.PCG64(seed)
    ).standard_normal(SAMPLES)
    values[begin:end] = level
    if channel != ROAD_WHEEL_ANGLE:  # its steps are checked after interpolation
        values[begin - empty[0] : begin] = np.nan
        values[end : end + empty[1]] = np.nan
    record = record_of({**TRUTH, channel: values})
    off = np.abs(record[channel] - TRUTH[channel])
    assert off[record.valid].max() < NOISE
    left_out = np.flatnonzero(~record.valid)
    assert len(left_out) <= length + sum(empty) + 2
    if len(left_out):
        assert left_out[0] >= begin - empty[0] - 1
        assert left_out[-1] <= end + empty[1]


@pytest.mark.parametrize(
    ("channel", "step"), [(LONGITUDINAL, 10.0), (YAW_RATE, -2.0), (LATERAL, 6.0)]
)
def test_no_window_leads_across_a_jump_that_stays(channel, step):
    """One of both sides is wrong, and the record does not show which: a car jumps on neither."""
    columns = {**TRUTH, channel: TRUTH[channel] + step * (TIME > 3.004)}
    record = record_of(columns)
    windows = windows_of(record, SHORTEST)
    begin, end = record.time[windows.first], record.time[windows.first + windows.size - 1]
    assert not ((begin < 3.005) & (end > 3.005)).any()
    assert begin[begin > 3.005][0] == pytest.approx(3.02)
    assert any(
        note.startswith(channel) and "jumps for good at 3.01 s, where windows" in note
        for note in record.notes
    )


@settings(deadline=None, max_examples=60)
@given(back=st.integers(3, 250), at=st.integers(260, 500))
def test_no_window_leads_across_a_clock_that_is_set_back(back, at):
    """Samples behind a step of three or more are late by it, whichever samples are passed over."""
    time = TIME - PERIOD * back * (np.arange(SAMPLES) >= at)
    # two drives in one
    record = record_of({**TRUTH, LONGITUDINAL: 20.0 + 5.0 * (np.arange(SAMPLES) >= at)}, time)
    windows = windows_of(record, SHORTEST)
    inside = windows.of(record[LONGITUDINAL])
    assert (np.ptp(inside, axis=1) < 1e-6).all()


def test_a_clock_that_is_set_back_is_named_with_its_time():
    time = TIME - 0.5 * (np.arange(SAMPLES) >= 400)
    record = record_of(dict(TRUTH), time)
    assert (
        "49 of 600 samples passed over: their times do not increase; it steps back at 3.52 s, where"
        in record.notes[0]
    )
    assert record.notes[0].startswith(f"{LONGITUDINAL}, {LATERAL}, ")


def test_equal_times_and_single_wrong_ones_are_no_clock_that_is_set_back():
    """Messages that were taken together have one stamp; a wrong reading leaves room for itself."""
    together = np.repeat(TIME[::4], 4)
    assert "steps back" not in " ".join(record_of(dict(TRUTH), together).notes)
    wrong = TIME.copy()
    wrong[[100, 200, 201, 202, 203]] = 0.0
    record = record_of(dict(TRUTH), wrong)
    assert "5 of 600 samples passed over" in record.notes[0]
    assert "steps back" not in " ".join(record.notes)


@settings(deadline=None, max_examples=30)
@given(together=st.integers(3, 12), apart=st.floats(1e-5, 1e-3))
def test_samples_in_bursts_have_the_period_of_their_sensor(together, apart):
    """A buffer hands several on at once.

    Their median distance is that of two messages on a line, not of two samples.

    What is read is late by the length of a burst at most, and all of it is believed.
    """
    number = np.arange(SAMPLES)
    arrival = PERIOD * together * (number // together + 1) + apart * (number % together)
    record = record_of(dict(TRUTH), arrival)
    # the first burst and the last one have no other side
    assert record.period == pytest.approx(PERIOD, rel=0.03)
    assert record.valid.all()
    assert "samples come in bursts" in record.notes[-1]
    late = PERIOD * together + apart * together
    off = np.abs(record[YAW_RATE] - 0.4 * np.sin(2.0 * record.time))
    assert off.max() < 0.8 * late + 1e-3  # the yaw rate changes by 0.8 rad/s^2 at most


def test_samples_that_are_lost_are_no_bursts():
    """Every fourth one of a log, and a part of it at a tenth of the rate."""
    kept = (np.arange(SAMPLES) % 4 > 0) & (
        (np.arange(SAMPLES) < 400) | (np.arange(SAMPLES) % 10 == 0)
    )
    columns = {name: values[kept] for name, values in TRUTH.items()}
    record = record_of(columns, TIME[kept])
    assert record.period == PERIOD
    assert "bursts" not in " ".join(record.notes)
