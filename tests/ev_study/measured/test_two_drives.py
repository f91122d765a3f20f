"""Two drives in one log: what is found of the second does not depend on the first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from measured.made_records import CAR, driven

from ev_study.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    LONGITUDINAL_ACCELERATION,
    ROAD_WHEEL_ANGLE,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_study.measured.replays.plausibility import contradictions
from ev_study.measured.replays.smoothing import rate_of, smoothed, with_acceleration

CHANNELS = (LONGITUDINAL, LATERAL, YAW_RATE, ROAD_WHEEL_ANGLE)
PERIOD = 0.01


def one_after_the_other(slower: float, gap: float, noise: float) -> MeasuredRecord:
    """The made drive, and behind a gap [s] the same at a share of the speed."""
    run = driven()
    random = np.random.Generator(np.random.PCG64(0))
    time = np.concatenate([run.time, run.time[-1] + gap + run.time])
    columns = {}
    for name in CHANNELS:
        factor = slower if name in (LONGITUDINAL, LATERAL) else 1.0
        values = np.concatenate([run.channels[name], factor * run.channels[name]])
        if name == LONGITUDINAL:
            rates = [np.gradient(each, PERIOD) for each in np.split(values, 2)]
            columns[LONGITUDINAL_ACCELERATION] = np.concatenate(rates)
            values = values + noise * random.standard_normal(len(values))
        columns[name] = values
    sampled = {
        name: (Sampled(time, values), ColumnParameters()) for name, values in columns.items()
    }
    return measured("made", "", sampled, MaskParameters())


def alone(record: MeasuredRecord, stretch: slice) -> MeasuredRecord:
    channels = {name: values[stretch] for name, values in record.channels.items()}
    return replace(record, channels=channels, valid=record.valid[stretch])


@pytest.mark.weekly
@settings(max_examples=15, deadline=None)
@given(
    slower=st.floats(0.2, 0.7),
    gap=st.sampled_from([PERIOD, 0.1, 0.3, 2.0]),
    noise=st.sampled_from([0.0, 0.05]),
)
def test_what_is_found_of_a_drive_does_not_depend_on_the_one_before_it(slower, gap, noise):
    """Speeds, their rates and all signals of all windows are those of each drive alone, to the bit.

    The speed of the drive before is no force, its angle no steering and its loads are not those
    with which the next one begins.
    """
    record = one_after_the_other(slower, gap, noise)
    assert len(record.stretches) == 2
    configurations = graph(CAR, PERIOD)
    both = OpenLoop(record, windows_of(record, 2.0), configurations, CHANNELS, cut_off=3.0)
    found = both.simulate()
    assert not any("acceleration" in line for line in contradictions(both))
    begun = 0
    for stretch in record.stretches:
        each = alone(record, stretch)
        speed = smoothed(record, LONGITUDINAL, 3.0)[stretch]
        assert np.array_equal(speed, smoothed(each, LONGITUDINAL, 3.0))
        rate = rate_of(record, record[LONGITUDINAL])[stretch]
        assert np.array_equal(rate, rate_of(each, each[LONGITUDINAL]))
        windows = windows_of(each, 2.0)
        expected = OpenLoop(each, windows, configurations, CHANNELS, cut_off=3.0).simulate()
        place = slice(begun, begun + len(windows))
        for name, values in expected.items():
            assert np.array_equal(found[name][:, place], values), name
        begun += len(windows)


def test_the_difference_of_two_drives_is_no_acceleration():
    """The line on the imposed speed has the car's 0.5 m/s^2, not the jump of 10 m/s."""
    record = one_after_the_other(0.5, PERIOD, 0.0)
    line = with_acceleration(record, smoothed(record, LONGITUDINAL, 3.0), 3.0)
    assert float(line.rpartition(" ")[2]) < 0.6
