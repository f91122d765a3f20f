"""Contradictions within a record, and fits that support no interval."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from measured.made_records import CAR, PERIOD, columns_of, driven, write

from ev_stack.commands.run_scenario import main
from ev_stack.scenarios.scenario import Overrides
from ev_study.measured.free_parameters import free_parameters
from ev_study.measured.identification import FLOORS, Fitted, Residuals, identify, moved_by_scales
from ev_study.measured.identified import PARTS, Identified
from ev_study.measured.intervals import knowledge
from ev_study.measured.records.record import (
    LATERAL,
    LATERAL_ACCELERATION,
    LONGITUDINAL,
    LONGITUDINAL_ACCELERATION,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_study.measured.replays.plausibility import contradictions
from ev_study.studies.result_store import Answers

CHANNELS = (
    LONGITUDINAL,
    LATERAL,
    YAW_RATE,
    ROAD_WHEEL_ANGLE,
    LATERAL_ACCELERATION,
    LONGITUDINAL_ACCELERATION,
)


def record_of(changed: dict[str, np.ndarray] | None = None) -> MeasuredRecord:
    run = driven()
    values = {name: run.channels[name] for name in CHANNELS} | (changed or {})
    noise = ColumnParameters(noise=0.001)
    return measured(
        "made", "", {n: (Sampled(run.time, v), noise) for n, v in values.items()}, MaskParameters()
    )


def replay_of(
    record: MeasuredRecord, length: float = 2.0, end: float = 1.0, inertia: float = 1.0
) -> OpenLoop:
    own = graph(CAR, PERIOD)["plant"].common.vehicle.yaw_inertia
    begun = graph(CAR, PERIOD, Overrides(values=[("*", "vehicle.yaw_inertia", inertia * own)]))
    return OpenLoop(
        record,
        windows_of(record, length, 0.0, end),
        begun,
        (LATERAL, YAW_RATE, LATERAL_ACCELERATION),
    )


def test_a_record_of_a_car_contradicts_itself_in_nothing():
    """Forwards, in reverse, and turned to the other side; with noise as well."""
    random = np.random.Generator(np.random.PCG64(0))
    noise = {
        n: driven().channels[n] + 0.02 * random.standard_normal(len(driven().time))
        for n in CHANNELS
    }
    assert contradictions(replay_of(record_of())) == []
    assert contradictions(replay_of(record_of(noise))) == []
    mirrored = {
        n: -driven().channels[n]
        for n in (LATERAL, YAW_RATE, ROAD_WHEEL_ANGLE, LATERAL_ACCELERATION)
    }
    assert contradictions(replay_of(record_of(mirrored))) == []


WRONG = [
    (YAW_RATE, -1.0, "twist.yaw_rate has the opposite sign of speed times steering angle"),
    (YAW_RATE, 57.3, "twist.yaw_rate is .* times as large as speed times steering angle .*: unit"),
    (YAW_RATE, 0.0, "twist.yaw_rate is 0 throughout though the car turns: not measured"),
    (ROAD_WHEEL_ANGLE, 0.0, "road_wheel_angle is 0 throughout"),
    (
        LATERAL_ACCELERATION,
        -1.0,
        "imu.lateral_acceleration has the opposite sign of speed times yaw rate",
    ),
    (LATERAL_ACCELERATION, 1 / 9.81, "imu.lateral_acceleration is 0.1.* unit"),
    (LONGITUDINAL, 3.6, "imu.lateral_acceleration is 0.2.* unit"),
    (
        LONGITUDINAL_ACCELERATION,
        -1.0,
        "imu.longitudinal_acceleration has the opposite sign of the change of speed",
    ),
    (LATERAL, 0.0, "twist.lateral is 0 throughout"),
]


@pytest.mark.parametrize(
    ("name", "factor", "line"), WRONG, ids=[f"{n} times {f:.3g}" for n, f, _ in WRONG]
)
def test_a_sensor_of_another_sign_or_unit_or_that_measures_nothing_is_named(name, factor, line):
    found = contradictions(replay_of(record_of({name: factor * driven().channels[name]})))
    assert found
    assert any(re.search(line, each) for each in found), found


@settings(max_examples=20, deadline=None)
@given(size=st.floats(3.0, 100.0), inverted=st.booleans(), negative=st.booleans())
def test_no_lateral_acceleration_of_another_size_or_sign_passes(size, inverted, negative):
    """Three to a hundred times too large or too small, either sign: at least one line."""
    factor = (1.0 / size if inverted else size) * (-1.0 if negative else 1.0)
    changed = {LATERAL_ACCELERATION: factor * driven().channels[LATERAL_ACCELERATION]}
    assert contradictions(replay_of(record_of(changed)))


def test_velocities_of_the_map_are_named():
    """A car that drives to the north-west: its sideslip angle would be 100 deg."""
    speed, heading = driven().channels[LONGITUDINAL], np.radians(100.0)
    of_map = {LONGITUDINAL: speed * np.cos(heading), LATERAL: speed * np.sin(heading)}
    found = contradictions(replay_of(record_of(of_map)))
    assert any("median sideslip angle is" in each and "frame" in each for each in found)


def test_identify_refuses_a_record_that_contradicts_itself_and_validate_notes_it(tmp_path, capsys):
    columns = columns_of(driven())
    columns["r"] = -columns["r"]
    record = str(write(tmp_path, columns))
    of = [record, "--vehicle", CAR, "--window", "2", "--no-report", "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit, match="opposite sign of speed times steering angle"):
        main(["identify", *of, "--free", "yaw"])
    main(["validate", *of])
    assert "note: twist.yaw_rate has the opposite sign" in capsys.readouterr().out


@pytest.mark.parametrize("option", ["starts", "steps", "every", "prior", "train", "window"])
@pytest.mark.parametrize("value", ["0", "-5"])
def test_a_number_of_an_option_has_ends(option, value, tmp_path):
    record = str(write(tmp_path, columns_of(driven())))
    with pytest.raises(SystemExit, match="is refused, expected"):
        main(["identify", record, "--vehicle", CAR, "--free", "yaw", f"--{option}={value}"])


@pytest.mark.parametrize("option", ["prior", "train", "window"])
@pytest.mark.parametrize("value", ["inf", "nan"])
def test_an_option_is_a_finite_number(option, value, tmp_path):
    record = str(write(tmp_path, columns_of(driven())))
    with pytest.raises(SystemExit, match="is refused, expected"):
        main(["identify", record, "--vehicle", CAR, "--free", "yaw", f"--{option}={value}"])


def fitted(replay: OpenLoop, most: int) -> Identified:
    free = free_parameters(["yaw"], replay.configurations)
    found = identify(
        replay, free, (YAW_RATE, SIDESLIP), every=5, width=1.0, starts=1, seed=0, most=most
    )
    known = knowledge(found.residuals, found.derivatives, found.values, free, 1.0, 0)
    return Identified(free, found, known, {PARTS[0]: replay}, {}, {}, "")


def test_a_search_out_of_steps_gives_no_interval_and_one_that_ends_does():
    """Begun 40 % off: one step is too few, eight are enough."""
    replay = replay_of(record_of(), inertia=1.4)
    short, whole = fitted(replay, 1), fitted(replay, 25)
    assert "used all of its --steps" in short.table()
    assert np.isnan(short.intervals).all()
    assert short.as_json("made")["identified"]["vehicle.yaw_inertia"]["interval"] is None
    assert "no interval" in short.notes()[0]
    assert whole.doubts == []
    assert np.isfinite(whole.intervals).all()
    assert " in 95 %" in whole.notes()[0]


@pytest.mark.parametrize(
    "channel", [LONGITUDINAL, pytest.param(ROAD_WHEEL_ANGLE, marks=pytest.mark.weekly)]
)
def test_what_the_scale_of_a_sensor_does_to_parameters_is_known_beforehand(channel):
    """A fit to a sensor that shows 2 % too much finds the predicted moves, to 5 % of the larger.

    A per cent of the speed moves inertia and cornering stiffness by 2 %, many of their deviations:
    the errors that are left are the same, so no fit sees it.
    """
    random = np.random.Generator(np.random.PCG64(0))
    noise = {YAW_RATE: 0.01, LATERAL: 0.05, LONGITUDINAL: 0.05}
    noisy = {
        n: driven().channels[n] + size * random.standard_normal(len(driven().time))
        for n, size in noise.items()
    }
    replay = replay_of(record_of(noisy), inertia=1.1)
    names = ["yaw", "vehicle.tyre.front_mf.pky1", "vehicle.tyre.rear_mf.pky1"]
    free = free_parameters(names, replay.configurations)

    def fit(of: OpenLoop) -> Fitted:
        return identify(
            of, free, (YAW_RATE, SIDESLIP), every=5, width=1.0, starts=1, seed=0, most=25
        )

    found, other = fit(replay), fit(replay.scaled(channel, 1.02))
    moved = 2.0 * moved_by_scales(replay, free, found, 5, 1.0)[channel]
    share, foretold = (other.values - found.values) / found.values, moved / found.values
    assert share == pytest.approx(foretold, abs=0.05 * np.abs(foretold).max())
    assert other.weights[YAW_RATE] == pytest.approx(found.weights[YAW_RATE], rel=0.01)
    if channel == LONGITUDINAL:
        assert foretold == pytest.approx(0.04, rel=0.3)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_error_that_is_left_is_that_of_what_was_measured(monkeypatch, share):
    """One weight off is one weight, with or without a sideslip angle in its windows."""
    record = record_of()
    record.channels[SIDESLIP][: int(0.7 * share * len(record.valid))] = np.nan
    replay = replay_of(record)
    weights = {YAW_RATE: 0.02, SIDESLIP: 0.01}
    of = Residuals(replay, free_parameters(["yaw"], replay.configurations), weights, 5, 1.0)
    off = np.concatenate(
        [np.isfinite(replay.measured(name)[:, ::5]).astype(float) for name in weights], axis=1
    )
    monkeypatch.setattr(of, "at", lambda points: off[None])
    assert of.left(of.begin, dict.fromkeys(weights, 0.0)) == pytest.approx(weights)


def test_one_window_gives_no_interval():
    assert any("one window" in each for each in fitted(replay_of(record_of(), 2.0, 0.2), 25).doubts)


def test_a_late_yaw_rate_is_named_and_gives_no_interval():
    """50 ms late: an inertia that is found from it is not that of the car."""
    rate = driven().channels[YAW_RATE]
    late = np.concatenate([np.full(5, rate[0]), rate[:-5]])
    found = fitted(replay_of(record_of({YAW_RATE: late}), inertia=1.1), 25)
    assert any(
        "twist.yaw_rate is measured 0.0" in each and " late" in each for each in found.doubts
    ), found.doubts
    assert np.isnan(found.intervals).all()


@pytest.mark.sampled
@pytest.mark.parametrize(
    "late", [0.25, 0.35, 1.0, None], ids=["0.25 s", "0.35 s", "1 s", "of another drive"]
)
def test_a_yaw_rate_that_is_not_that_of_the_car_gives_no_interval(late):
    """It is late beyond the lags that are looked for, or quite another one."""
    rate = driven().channels[YAW_RATE]
    back = round((late or 0.0) / PERIOD)
    other = (
        np.concatenate([np.full(back, rate[0]), rate[: len(rate) - back]]) if late else rate[::-1]
    )
    found = fitted(replay_of(record_of({YAW_RATE: other}), inertia=1.1), 25)
    assert any(
        "off twist.yaw_rate in the median window, which itself deviates by" in each
        for each in found.doubts
    )
    assert np.isnan(found.intervals).all()


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "offset", "line"),
    [
        (
            YAW_RATE,
            0.02,
            r"the fit is -0\.0\d+ rad/s off twist\.yaw_rate on average: offset of a sensor",
        ),
        (YAW_RATE, -0.02, r"the fit is \+0\.0\d+ rad/s off twist\.yaw_rate on average"),
        (LATERAL, 0.2, r"the fit is -0\.0\d+ rad off sideslip on average"),
        (ROAD_WHEEL_ANGLE, 0.02, r"the fit is \+0\.\d+ rad/s off twist\.yaw_rate on average"),
        (YAW_RATE, 0.003, ""),
    ],
    ids=["gyro", "gyro, negative", "velocity to the side", "steering", "less than noise"],
)
def test_an_offset_of_a_sensor_is_named_and_gives_no_interval(name, offset, line):
    """All windows have it: their differences, and so the intervals, do not show it."""
    found = fitted(
        replay_of(
            replace(record_of({name: driven().channels[name] + offset}), noise={}), inertia=1.1
        ),
        25,
    )
    assert any(re.search(line, each) for each in found.doubts) == bool(line), found.doubts
    assert np.isnan(found.intervals).all() == bool(line)


def test_a_number_at_the_end_of_its_range_has_no_interval():
    found = fitted(replay_of(record_of()), 25)
    free = replace(found.free[0], high=float(found.fitted.values[0]))
    at_end = replace(found, free=(free,))
    assert at_end.doubts == []
    assert np.isnan(at_end.intervals).all()
    assert "at the end of its range" in at_end.notes()[0]
    assert "vehicle.yaw_inertia is at the end of its range" in at_end.table()


def test_a_signal_that_got_worse_is_named():
    """A result that is further from the record than the start was is no optimum of it."""
    found = fitted(replay_of(record_of()), 25)
    worse = replace(found, fitted=replace(found.fitted, values=1.5 * found.fitted.values))
    assert any(
        "twist.yaw_rate is reproduced worse than at the start" in each for each in worse.doubts
    )


def test_no_signal_weighs_more_than_its_sensor_allows():
    """The floor is the mapping's noise, 0.001 rad/s here, or that of a good sensor."""
    declared = record_of()
    for record, floor in ((declared, 0.001), (replace(declared, noise={}), FLOORS[YAW_RATE])):
        replay = replay_of(record)
        found = identify(replay, free_parameters(["yaw"], replay.configurations), (YAW_RATE,), every=5, width=1.0,
                         starts=1, seed=0, most=25)  # fmt: skip
        assert found.weights[YAW_RATE] == floor


def test_a_fit_of_which_answers_are_kept_is_that_of_one_without():
    """Both fits ask at one point, by other weights.

    Once more all of it is kept, and the bits are the same.
    """
    noise = 0.01 * np.random.Generator(np.random.PCG64(1)).standard_normal(len(driven().time))
    replay = replay_of(
        replace(record_of({YAW_RATE: driven().channels[YAW_RATE] + noise}), noise={}), inertia=1.2
    )
    free = free_parameters(["yaw"], replay.configurations)
    results: dict[str, bytes] = {}
    plain, *others = (
        identify(
            replay,
            free,
            (YAW_RATE, LATERAL),
            every=5,
            width=1.0,
            starts=1,
            seed=0,
            most=10,
            answers=answers,
        )
        for answers in (None, Answers(results, "a"), Answers(results, "a"))
    )
    for other in others:
        assert other.weights == plain.weights
        for name in ("values", "residuals", "derivatives"):
            assert np.array_equal(getattr(other, name), getattr(plain, name)), name


def test_what_was_not_measured_is_no_error():
    """A sideslip angle that is NaN at the beginning of a window.

    The errors there are zero, elsewhere they count.
    """
    record = record_of()
    record.channels[SIDESLIP][:100] = np.nan
    replay = replay_of(record, inertia=1.5)
    of = Residuals(
        replay, free_parameters(["yaw"], replay.configurations), {SIDESLIP: 0.001}, 1, 1.0
    )
    first = of.at(of.begin[None])[0][0]
    assert (first[:100] == 0.0).all()
    assert np.abs(first[100:]).max() > 0.0
