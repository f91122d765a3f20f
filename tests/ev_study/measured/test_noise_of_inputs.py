"""Noise of what is imposed or begun from, standstill, and sensors beside the centre of mass."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from measured.made_records import CAR, PERIOD, driven

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_study.measured.replays.errors import spins
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_study.measured.replays.smoothing import (
    LEFT,
    LOWEST,
    SMOOTHED,
    cut_off_of,
    noise_of,
    smoothed,
)
from ev_study.measured.replays.validation import Validation, signals_to_show

IMPOSED_AND_COMPARED = (LONGITUDINAL, LATERAL, YAW_RATE, ROAD_WHEEL_ANGLE)


def record_of(
    changed: dict[str, np.ndarray] | None = None, places: dict[str, float] | None = None
) -> MeasuredRecord:
    """The made record with other values of some channels, measured so far ahead [m]."""
    run = driven()
    values = {name: run.channels[name] for name in IMPOSED_AND_COMPARED} | (changed or {})
    placed = {name: ColumnParameters(x=(places or {}).get(name, 0.0)) for name in values}
    return measured(
        "made",
        "",
        {n: (Sampled(run.time, v), placed[n]) for n, v in values.items()},
        MaskParameters(),
    )


def validated(record: MeasuredRecord) -> Validation:
    replay = OpenLoop(record, windows_of(record, 2.0), graph(CAR, PERIOD), signals_to_show())
    return Validation(replay, {name: values[0] for name, values in replay.simulate().items()}, 0.0)


@pytest.mark.parametrize("kind", ["noise", "quantised", "held"])
def test_noise_of_the_imposed_speed_is_no_force_of_the_tyres(kind):
    """The yaw rate is within 0.0006 rad/s, a seventh of what raw differences would give.

    Noise of 0.05 m/s at 100 Hz, steps of 0.1 m/s, and a speed of 10 Hz that is held. The line on it
    has the acceleration of the raw samples.
    """
    random, speed = np.random.Generator(np.random.PCG64(0)), driven().channels[LONGITUDINAL]
    given = {
        "noise": speed + 0.05 * random.standard_normal(len(speed)),
        "quantised": np.round(speed / 0.1) * 0.1,
        "held": np.repeat(speed[::10], 10)[: len(speed)],
    }[kind]
    found = validated(record_of({LONGITUDINAL: given}))
    errors = found.simulated[YAW_RATE] - found.replay.windows.of(driven().channels[YAW_RATE])
    assert np.sqrt(np.mean(errors**2)) < 6e-4
    (line,) = [note for note in found.notes() if "imposed speed is smoothed" in note]
    if kind == "noise":
        # m/s^2, 0.05 sqrt(2)/0.01
        assert float(line.rpartition(" ")[2]) == pytest.approx(7.1, rel=0.05)


def test_a_window_begins_from_smoothed_values():
    """A quarter of noise of 0.01 rad/s and 0.05 m/s is left at the begin, in reverse as well."""
    random = np.random.Generator(np.random.PCG64(0))
    sizes = {YAW_RATE: 0.01, LATERAL: 0.05}
    noise = {
        name: size * random.standard_normal(len(driven().time)) for name, size in sizes.items()
    }
    for sign in (1.0, -1.0):
        record = record_of(
            {name: sign * driven().channels[name] + each for name, each in noise.items()}
        )
        for name, each in noise.items():
            left = smoothed(record, name) - sign * driven().channels[name]
            assert np.std(left[50:-50]) < 0.4 * np.std(each)


def test_an_even_acceleration_passes_the_filter_unchanged():
    """Neither a delay nor a smaller slope; at the ends, where the filter swings in, 1 mm/s.

    A short record stays.
    """
    ramp = np.linspace(5.0, 25.0, len(driven().time))
    record = record_of({LONGITUDINAL: ramp})
    assert smoothed(record, LONGITUDINAL, 3.0) == pytest.approx(ramp, abs=1e-3)
    assert smoothed(record, LONGITUDINAL, 3.0)[100:-100] == pytest.approx(ramp[100:-100], abs=1e-5)
    few = Sampled(np.arange(8) * 0.01, np.ones(8))
    short = measured("short", "", {YAW_RATE: (few, ColumnParameters())}, MaskParameters())
    assert smoothed(short, YAW_RATE, 3.0) is short[YAW_RATE]


def test_a_record_without_noise_stays_as_it_is():
    """Bit by bit, and so does the car that is replayed: no rounding of pedals and bends.

    The line says so.
    """
    record = record_of()
    for name in SMOOTHED:
        assert smoothed(record, name) is record[name]
    assert any("imposed speed is not smoothed" in note for note in validated(record).notes())


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 1000), noise=st.floats(0.003, 0.2), rate=st.sampled_from([20, 50, 100, 200])
)
def test_the_noise_that_is_left_makes_a_hundredth_of_what_a_car_does(seed, noise, rate):
    """White noise of any size, braking and driving off with up to 5 m/s^2, at 20 to 200 Hz.

    Of 0.1 m/s^2 a tenth more for its chance, unless the lowest cut-off was needed. Less noise has a
    higher cut-off.
    """
    time = np.arange(0.0, 60.0, 1.0 / rate)
    true = 20.0 + 10.0 * np.sin(0.5 * time)
    random = np.random.Generator(np.random.PCG64(seed))
    values = true + noise * random.standard_normal(len(time))
    record = measured(
        "made", "", {LONGITUDINAL: (Sampled(time, values), ColumnParameters())}, MaskParameters()
    )
    assert noise_of(record, LONGITUDINAL) == pytest.approx(noise, rel=0.15)
    cut_off = cut_off_of(record, LONGITUDINAL)
    left = np.diff(smoothed(record, LONGITUDINAL) - true)[rate:-rate] * rate
    if cut_off != LOWEST:
        assert np.std(left) < 1.35 * LEFT[LONGITUDINAL]
    assert cut_off >= LOWEST or cut_off == 0.0


@pytest.mark.parametrize("rate", [10, 20, 50])
def test_noise_of_a_slow_sensor_is_seen_between_its_own_samples(rate):
    """A speed of 10 to 50 Hz beside a yaw rate of 100 Hz.

    Straight lines between its samples hide no noise.
    """
    run = driven()
    random, slow = np.random.Generator(np.random.PCG64(0)), run.time[:: 100 // rate]
    values = np.interp(slow, run.time, run.channels[LONGITUDINAL]) + 0.05 * random.standard_normal(
        len(slow)
    )
    columns = {LONGITUDINAL: (Sampled(slow, values), ColumnParameters())}
    columns |= {
        n: (Sampled(run.time, run.channels[n]), ColumnParameters())
        for n in (YAW_RATE, ROAD_WHEEL_ANGLE)
    }
    record = measured("made", "", columns, MaskParameters())
    assert noise_of(record, LONGITUDINAL) == pytest.approx(0.05, rel=0.3)  # of 120 samples or more
    assert LOWEST <= cut_off_of(record, LONGITUDINAL) < 3.0


def test_noise_of_a_slow_sideslip_sensor_is_seen_in_the_lateral_velocity_that_follows_from_it():
    """20 Hz beside 100 Hz, 0.005 rad: at 12 m/s and more at least 0.06 m/s."""
    run = driven()
    random, slow = np.random.Generator(np.random.PCG64(0)), run.time[::5]
    angle = np.arctan2(run.channels[LATERAL], run.channels[LONGITUDINAL])[::5]
    columns = {
        n: (Sampled(run.time, run.channels[n]), ColumnParameters())
        for n in (YAW_RATE, LONGITUDINAL)
    }
    columns[SIDESLIP] = (
        Sampled(slow, angle + 0.005 * random.standard_normal(len(slow))),
        ColumnParameters(),
    )
    record = measured("made", "", columns, MaskParameters())
    expected = 0.005 * float(np.sqrt(np.mean(run.channels[LONGITUDINAL] ** 2)))
    assert noise_of(record, LATERAL) == pytest.approx(expected, rel=0.3)  # of 240 samples


def test_a_car_at_rest_has_no_sideslip_and_no_window():
    """5 s at rest with noise of 0.01 m/s.

    No sideslip angle there, its windows passed over and counted, no spin.
    """
    random, run = np.random.Generator(np.random.PCG64(0)), driven()
    rest = run.time < 5.0
    values = {name: np.where(rest, 0.0, run.channels[name]) for name in IMPOSED_AND_COMPARED}
    for name in (LONGITUDINAL, LATERAL):
        values[name] = values[name] + 0.01 * random.standard_normal(len(rest))
    drives_off = np.minimum(values[LONGITUDINAL], 8.0 * (run.time - 5.0))
    values[LONGITUDINAL] = np.where(rest, values[LONGITUDINAL], drives_off)
    record = record_of(values)
    assert np.isnan(record[SIDESLIP][:490]).all()
    assert np.isfinite(record[SIDESLIP][600:]).all()
    found = validated(record)
    assert found.replay.windows.at_rest == 2
    assert any("2 windows in which the car stands" in note for note in found.notes())
    assert not found.spun[1:].any()
    standing = record_of({LONGITUDINAL: np.full(len(rest), 0.01)})
    with pytest.raises(ParameterError, match=r"6 in which the car stands"):
        windows_of(standing, 2.0)


def test_no_spin_is_judged_where_no_sideslip_was_measured():
    """An angle that is off by 90 deg where none was measured.

    A number that is not finite spins all the same.
    """
    measured_angle = np.array([[np.nan, 0.0], [0.0, 0.0], [np.nan, 0.0]])
    assert spins(np.array([[1.6, 0.0], [1.6, 0.0], [np.nan, 0.0]]), measured_angle).tolist() == [
        False,
        True,
        True,
    ]


@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_sideslip_sensor_is_moved_to_the_centre_of_mass_and_gives_the_lateral_velocity(
    mirror, direction
):
    """1.5 m ahead the velocity to the side is v + 1.5 r.

    Forwards, in reverse, and turned to the other side.
    """
    run = driven()
    speed, lateral, rate = (run.channels[n] for n in (LONGITUDINAL, LATERAL, YAW_RATE))
    speed, lateral, rate = direction * speed, mirror * lateral, mirror * rate
    ahead = np.arctan((lateral + 1.5 * rate) / speed)
    columns = {
        LONGITUDINAL: (Sampled(run.time, speed), ColumnParameters()),
        YAW_RATE: (Sampled(run.time, rate), ColumnParameters()),
        SIDESLIP: (Sampled(run.time, ahead), ColumnParameters(x=1.5)),
    }
    record = measured("made", "", columns, MaskParameters())
    assert record[LATERAL] == pytest.approx(lateral, abs=1e-9)
    assert record[SIDESLIP] == pytest.approx(np.arctan(lateral / speed), abs=1e-9)


def test_a_place_is_refused_for_a_channel_that_has_none():
    """An angle of the steering is the same wherever it is measured.

    A yaw rate too, but its sensor has a place.
    """
    with pytest.raises(
        ParameterError, match=r"road_wheel_angle: x and y are refused, expected for twist"
    ):
        record_of(places={ROAD_WHEEL_ANGLE: 1.0})
    assert np.array_equal(record_of(places={YAW_RATE: 1.0})[YAW_RATE], record_of()[YAW_RATE])


@pytest.mark.parametrize("sign", [0.0, 0.5, -0.99])
def test_a_sign_is_one_or_minus_one(sign):
    with pytest.raises(ParameterError, match="expected 1 or -1"):
        ColumnParameters(sign=sign)


@pytest.mark.parametrize("length", [0.0, -5.0, 1e-9, 0.05, np.inf, np.nan, 1e9])
def test_a_window_that_is_no_length_is_refused(length):
    """It is neither looked for without end nor a traceback."""
    with pytest.raises(ParameterError, match=r"is refused, expected 0\.09 to"):
        windows_of(record_of(), length)
