"""A batch is its runs one by one, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from batches.batches import DURATION, RUNS, alone, lane_change, vary

from ev_core.lockstep.parts import compiled_part, method_part
from ev_stack.batches.batch import batch
from ev_stack.batches.observer import (
    largest_magnitude,
    last,
    maximum,
    mean,
    minimum,
    root_mean_square,
)
from ev_stack.batches.whole_runs import Ending
from ev_stack.measures.named import DrivenRun
from ev_stack.recording.offline import run_offline

SIGNALS = (
    "imu.yaw_rate",
    "wheel_states.velocity.rear_left",
    "pose.orientation_z",
    "driver.command.hand_torque",
)
METRICS = {
    "lowest": minimum("pose.y"),
    "highest": maximum("pose.y"),
    "largest": largest_magnitude("twist.lateral"),
    "end": last("pose.x"),
    "mean": mean("imu.yaw_rate"),
    "rms": root_mean_square("imu.yaw_rate"),
}


@pytest.mark.parametrize("threads", [None, 1, 3])
def test_each_run_is_as_alone(threads):
    found = batch(
        lane_change(), DURATION, vary(), signals=SIGNALS, every=10, metrics=METRICS, threads=threads
    )
    assert not found.failed
    for run in range(RUNS):
        recording = alone(run)
        assert found.time.tobytes() == recording.time[::10].tobytes()
        for name in SIGNALS:
            assert found.signals[name][run].tobytes() == recording.channels[name][::10].tobytes()
        y, v, rate = (
            recording.channels[name] for name in ("pose.y", "twist.lateral", "imu.yaw_rate")
        )
        got = {name: values[run] for name, values in found.metrics.items()}
        assert (got["lowest"], got["highest"], got["largest"]) == (
            y.min(),
            y.max(),
            np.abs(v).max(),
        )
        assert got["end"] == recording.channels["pose.x"][-1]
        # Sums of 301 numbers in another order: each addition is off by half of the last place of
        # the sum at most.
        assert got["mean"] == pytest.approx(rate.mean(), abs=301 * 2**-53 * np.abs(rate).mean())
        assert got["rms"] == pytest.approx(np.sqrt((rate**2).mean()), rel=301 * 2**-53)


def test_neighbours_and_order_do_not_matter():
    """Backwards, and one of them alone in its batch."""
    forwards, backwards, single = (
        batch(
            lane_change(),
            1.0,
            {name: v[part] for name, v in vary().items()},
            signals=SIGNALS,
            metrics=METRICS,
        )
        for part in (slice(None), slice(None, None, -1), slice(2, 3))
    )
    for kind in ("signals", "metrics"):
        for name, values in getattr(forwards, kind).items():
            assert values.tobytes() == getattr(backwards, kind)[name][::-1].tobytes()
            assert values[2:3].tobytes() == getattr(single, kind)[name].tobytes()
    assert len(np.unique(forwards.signals["imu.yaw_rate"], axis=0)) == RUNS


def test_states_to_begin_with():
    """That of a car at 20 and 24 m/s, as the parameter `initial_speed` makes it."""
    speeds = (20.0, 24.0)
    plants = [lane_change()["plant"].changed({"initial_speed": speed}) for speed in speeds]
    rows = [method_part(plant, compiled=True).state for plant in plants]
    by_state = batch(lane_change(), 1.0, initial_states={"plant": rows}, signals=SIGNALS)
    by_parameter = batch(
        lane_change(), 1.0, {"plant.initial_speed": np.array(speeds)}, signals=SIGNALS
    )
    for name in SIGNALS:
        assert by_state.signals[name].tobytes() == by_parameter.signals[name].tobytes()


def test_a_batch_of_nothing_else_is_the_run_itself():
    found = batch(lane_change(), 1.0, signals=["pose.x"], every=7)
    assert found.signals["pose.x"].shape == (1, 15)
    recording = run_offline(lane_change(), 1.0)
    assert found.signals["pose.x"][0].tobytes() == recording.channels["pose.x"][::7].tobytes()
    assert found.metrics == {}
    assert found.ends.tolist() == [1.0]


def test_a_run_that_is_not_finite_stops_alone():
    """A lateral velocity of 1e300 m/s is infinite when it is squared.

    The neighbours do not notice.
    """
    rows = np.repeat(method_part(lane_change()["plant"], compiled=True).state[None], 3, axis=0)
    good = batch(
        lane_change(), 1.0, initial_states={"plant": rows}, signals=SIGNALS, metrics=METRICS
    )
    rows[1, 1] = 1e300
    found = batch(
        lane_change(), 1.0, initial_states={"plant": rows}, signals=SIGNALS, metrics=METRICS
    )
    assert not good.failed
    assert list(found.failed) == [1]
    assert "expected a finite number" in found.failed[1]
    assert np.isnan(found.ends).tolist() == [False, True, False]
    for kind in ("signals", "metrics"):
        for name, values in getattr(found, kind).items():
            assert values[[0, 2]].tobytes() == getattr(good, kind)[name][[0, 2]].tobytes()
            assert np.isnan(values[1]).any()


def test_a_run_that_ends_early_has_the_bits_of_a_shorter_one():
    """Each ends at the first half second behind 20 m, the last one never.

    Sensors, faults and truth as ever.
    """
    looks: list[tuple[float, float]] = []

    def is_far(run: DrivenRun, since: int) -> bool:
        looks.append((float(run.signals.time[since]), float(run.signals.time[-1])))
        x = run.signals.channels["pose.x"]
        return bool(x[-1] - x[0] > 20.0)

    values = {**vary(), "plant.initial_speed": [30.0, 18.0, 26.0, 21.0, 1.0]}
    metrics = ["peak_sideslip", "distance"]
    found = batch(
        lane_change(),
        DURATION,
        values,
        metrics=metrics,
        hashes=True,
        threads=1,
        ending=Ending(is_far, 0.5),
    )
    assert found.ends.tolist() == [1.0, 1.5, 1.0, 1.0, 3.0]
    assert looks[:4] == [(0.0, 0.5), (0.5, 1.0), (0.0, 0.5), (0.5, 1.0)]
    for run, end in enumerate(found.ends.tolist()):
        alone = batch(
            lane_change(),
            end,
            {n: [of[run]] for n, of in values.items()},
            metrics=metrics,
            hashes=True,
        )
        assert found.hashes[run] == alone.hashes[0]
        assert [found.metrics[name][run] for name in metrics] == [
            alone.metrics[name][0] for name in metrics
        ]


def test_only_what_differs_is_prepared_again(monkeypatch):
    """Seeds concern sensors only; a parameter of the plant only the plant."""
    made = []

    def counted(configuration, like=None):
        made.append(configuration.role)
        return compiled_part(configuration, like)

    monkeypatch.setattr("ev_stack.batches.placed.compiled_part", counted)
    batch(lane_change(), 0.1, {"*.seed": range(20)})
    assert sorted(made) == sorted(lane_change())
    made.clear()
    batch(lane_change(), 0.1, {"plant.initial_speed": [20.0] * 20})
    assert made.count("plant") == 21
    assert len(made) == 25


def test_a_part_takes_the_function_of_one_that_is_laid_out_alike_and_of_no_other(monkeypatch):
    """The function is not looked for again: that takes a third of the time of a short run."""
    plant, column = lane_change()["plant"], lane_change()["steering_column"]
    first, other = method_part(plant, compiled=True), method_part(column, compiled=True)
    assert (
        method_part(column, compiled=True, like=first).function == other.function != first.function
    )
    monkeypatch.setattr("ev_core.compiled.part.function_address", None)
    heavier = method_part(plant.changed({"vehicle.mass": 2000.0}), compiled=True, like=first)
    assert heavier.function == first.function
    assert (heavier.constants != first.constants).any()
