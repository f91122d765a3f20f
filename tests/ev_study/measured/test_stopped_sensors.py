"""Sensors that stop, or at the end of their range, and channels present for a time only."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.record import (
    LATERAL,
    LATERAL_ACCELERATION,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    measured,
)
from ev_study.measured.records.samples import Sampled
from ev_study.measured.replays.open_loop import windows_of

TIME = 0.01 * np.arange(3000)
WAVE = np.sin(2.0 * TIME)
TRUTH = {
    LONGITUDINAL: 20.0 + np.sin(0.3 * TIME),
    LATERAL: 0.3 * np.sin(2.0 * TIME - 0.3),
    YAW_RATE: 0.4 * WAVE,
    LATERAL_ACCELERATION: 8.0 * np.sin(2.0 * TIME + 0.1),
    ROAD_WHEEL_ANGLE: 0.06 * np.sin(2.0 * TIME + 0.2),
}
FOLLOWERS = (YAW_RATE, LATERAL, LATERAL_ACCELERATION)


def record_of(changed: dict[str, np.ndarray], time: np.ndarray = TIME) -> MeasuredRecord:
    columns = {**TRUTH, **changed}
    sampled = {name: (Sampled(time, each), ColumnParameters()) for name, each in columns.items()}
    return measured("made", "", sampled, MaskParameters())


@settings(max_examples=60, deadline=None)
@given(
    channel=st.sampled_from(FOLLOWERS),
    begin=st.integers(0, 2900),
    length=st.integers(31, 2000),
    noise=st.sampled_from([0.0, 0.01]),
    sign=st.sampled_from([1.0, -1.0]),
    seed=st.integers(0, 9),
)
def test_what_a_sensor_shows_that_has_stopped_is_not_believed(
    channel, begin, length, noise, sign, seed
):
    """It is never off by more than 0.4 of its range, both ways, to the end of the record.

    What it follows has to move by a tenth of its own range first, which may be half a radian ahead,
    and 0.2 s are left for the car to answer: 0.2 of the range of this wave.
    """
    random = np.random.Generator(np.random.PCG64(seed))
    size = np.ptp(TRUTH[channel])
    values = TRUTH[channel] + noise * size * random.standard_normal(len(TIME))
    values[begin : begin + length] = values[begin]
    record = record_of({channel: values, LONGITUDINAL: sign * TRUTH[LONGITUDINAL]})
    off = np.abs(record[channel] - TRUTH[channel])
    assert off[record.valid].max() < 0.4 * size
    away = np.flatnonzero(~record.valid)
    assert not len(away) or (begin - 1 <= away[0] and away[-1] <= begin + length)


@pytest.mark.parametrize("channel", FOLLOWERS)
def test_a_sensor_at_the_end_of_its_range_is_masked_and_named(channel):
    """Half of a wave is cut off.

    What is kept is right, and the line has the channel and how long.
    """
    most = 0.5 * np.abs(TRUTH[channel]).max()
    record = record_of({channel: np.clip(TRUTH[channel], -most, most)})
    assert 0.3 < record.valid.mean() < 0.4  # 2/3 of a wave is beyond half of it
    assert np.abs(record[channel] - TRUTH[channel])[record.valid].max() < 0.02 * most
    (line,) = [note for note in record.notes if "shows one number" in note]
    assert line.startswith(f"{channel} shows one number for ")
    assert line.endswith("the sensor has stopped, or is at the end of its range")


@settings(max_examples=60, deadline=None)
@given(
    channel=st.sampled_from(FOLLOWERS),
    kind=st.sampled_from(["steps", "held", "dead band"]),
    share=st.floats(0.001, 0.3),
    phase=st.floats(-1.5, 1.5),
)
def test_steps_holds_and_dead_bands_of_a_sensor_are_believed(channel, kind, share, phase):
    """Steps of up to 0.3 of its range, holds of up to 0.3 s, zero within 0.05 of the range.

    The sensor may be ahead of or behind what it follows by up to a quarter of a wave.
    """
    size = np.ptp(TRUTH[channel])
    values = 0.5 * size * np.sin(2.0 * TIME + phase)
    if kind == "steps":
        values = np.round(values / (share * size)) * share * size
    elif kind == "held":
        samples = max(round(100.0 * share), 1)
        values = values[np.arange(len(TIME)) // samples * samples]
    else:
        values = np.where(np.abs(values) < 0.05 * size, 0.0, values)
    record = record_of({channel: values})
    assert not [note for note in record.notes if "shows one number" in note]


def test_a_car_that_goes_straight_or_stands_has_no_sensor_that_has_stopped():
    """Exact zeros of a simulated car until it steers, and of one steered at rest."""
    step = np.where(TIME < 10.0, 0.0, 1.0 - np.exp(10.0 - np.maximum(TIME, 10.0)))
    record = record_of(
        {
            YAW_RATE: 0.3 * step,
            ROAD_WHEEL_ANGLE: 0.05 * (TIME >= 10.0),
            LATERAL: 0.1 * step,
            LATERAL_ACCELERATION: 6.0 * step,
        }
    )
    assert not [note for note in record.notes if "shows one number" in note]
    still = record_of(
        {
            LONGITUDINAL: np.zeros(len(TIME)),
            YAW_RATE: np.zeros(len(TIME)),
            LATERAL: np.zeros(len(TIME)),
            LATERAL_ACCELERATION: np.zeros(len(TIME)),
        }
    )
    assert not [note for note in still.notes if "shows one number" in note]


def test_a_steering_angle_that_is_held_is_believed():
    """A robot holds it to the bit while the speed changes, and the yaw rate with it."""
    speed = 15.0 + 0.3 * TIME
    record = record_of(
        {
            LONGITUDINAL: speed,
            ROAD_WHEEL_ANGLE: np.full(len(TIME), 0.03),
            YAW_RATE: 0.01 * speed,
            LATERAL_ACCELERATION: 0.01 * speed**2,
            LATERAL: 0.01 * speed,
        }
    )
    assert record.valid.all()


def test_a_sideslip_sensor_that_has_stopped_is_masked():
    angle = 0.02 * np.sin(2.0 * TIME)
    angle[1000:1500] = angle[1000]
    columns = {name: each for name, each in TRUTH.items() if name != LATERAL} | {SIDESLIP: angle}
    sampled = {name: (Sampled(TIME, each), ColumnParameters()) for name, each in columns.items()}
    record = measured("made", "", sampled, MaskParameters())
    assert not record.valid[1000:1500].any()
    assert record.valid[:1000].all()


@pytest.mark.parametrize(
    ("late", "early", "line"),
    [
        (0, 1000, "of 0.00 to 29.99 s only 0.00 to 9.99 s count, in which all channels are there"),
        (2000, 3000, "of 0.00 to 29.99 s only 20.00 to 29.99 s count"),
    ],
)
def test_a_channel_that_is_not_there_all_the_while_is_named(late, early, line):
    """It costs the record all that is ahead of it or behind it."""
    part = Sampled(TIME[late:early], TRUTH[LATERAL_ACCELERATION][late:early])
    sampled = {name: (Sampled(TIME, each), ColumnParameters()) for name, each in TRUTH.items()}
    sampled[LATERAL_ACCELERATION] = (part, ColumnParameters())
    record = measured("made", "", sampled, MaskParameters())
    (note,) = record.notes
    assert note.startswith(line)
    assert LATERAL_ACCELERATION in note
    assert len(record.valid) == early - late


def test_loggers_that_start_one_by_one_are_no_note():
    """Up to a second apart."""
    sampled = {name: (Sampled(TIME, each), ColumnParameters()) for name, each in TRUTH.items()}
    sampled[LATERAL] = (Sampled(TIME[90:-90], TRUTH[LATERAL][90:-90]), ColumnParameters())
    assert measured("made", "", sampled, MaskParameters()).notes == ()


def test_a_record_that_is_too_short_for_any_window_has_a_line_of_its_own():
    """No range of windows of which the upper end is below the lower one."""
    record = record_of({name: each[:5] for name, each in TRUTH.items()}, TIME[:5])
    with pytest.raises(
        ParameterError, match=r"made lasts 0.05 s, expected 0.09 s or more: the unit"
    ):
        windows_of(record, 2.0)
