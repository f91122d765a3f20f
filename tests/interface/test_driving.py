"""ev_sim.run and ev_sim.batch: what a notebook calls."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

import ev_sim
from ev_msgs_py.refusal import ParameterError
from ev_sim.batches.observer import last
from ev_sim.commands.run_scenario import main
from ev_sim.recording.recording import load, signal_hash


@pytest.fixture(scope="module")
def result():
    changed = {"electronic_differential.gamma": 4.0, "*.control_period": 0.02}
    return ev_sim.run("shchur2019", method={"asr": "off"}, set=changed, seed=3, duration=1.0)


@pytest.mark.slow
def test_a_run_is_that_of_the_command(result, tmp_path):
    """Which has the hash of all other ways to run (tests/running/test_hashes.py, test_machines.py)."""
    words = ["--set", "electronic_differential.gamma=4.0", "--set", "*.control_period=0.02", "--seed", "3"]
    main(["shchur2019", "--offline", "--no-record", "--duration", "1", *words, "--out", str(tmp_path / "command")])
    result.save(tmp_path / "saved")
    said, saved = (json.loads((tmp_path / name / "summary.json").read_text()) for name in ("command", "saved"))
    assert said["signal_hash"] == saved["signal_hash"] == result.hash
    for of_run in ("wall_time", "real_time_factor", "command"):
        del said[of_run], saved[of_run]
    assert said == saved
    assert signal_hash(load(tmp_path / "saved" / "signals.npz")) == saved["runs"]["shchur2019"]["signal_hash"]
    names = [sorted(path.name for path in (tmp_path / name).glob("*.png")) for name in ("command", "saved")]
    assert names[0] == names[1] != []


def test_signals_are_arrays_over_time(result):
    assert result.time.tolist() == pytest.approx(np.arange(0.0, 1.01, 0.02).tolist())
    assert result.signals["twist.longitudinal"].shape == result.time.shape
    assert {"m/s", "rad"} <= {metric.unit for metric in result.metrics.values()}
    assert result._repr_html_().count("<img ") == 1


def test_a_data_frame_needs_pandas(result, monkeypatch):
    """It is not among what the packages need; the error is Python's own, which names it."""
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pandas"):
        result.data_frame()


def test_of_several_runs_one_is_named():
    both = ev_sim.run("shchur2019_steps", runs=("object", "hold_manual"), duration=0.02)
    assert list(both.runs) == ["object", "hold_manual"]
    with pytest.raises(
        ParameterError, match=r"^shchur2019_steps has several runs: runs\[NAME\] of object, hold_manual$"
    ):
        _ = both.signals


def test_a_scenario_of_ones_own_brings_its_metrics(tmp_path):
    path = tmp_path / "mine.yaml"
    about = "{about: mine, duration: 0.1, metrics: ['v = last(twist.longitudinal)']}"
    path.write_text(
        f"/**/scenario:\n  ros__parameters: {about}\n/**/plant:\n  ros__parameters: {{initial_speed: 5.0}}\n"
    )
    found = ev_sim.run(path).metrics
    assert found["v"].value == found["final_speed"].value != 0.0
    assert found["v"].unit == "m/s"


def test_a_batch_is_the_runs_one_by_one():
    speeds = [2.0, 8.0]
    end = {"end": last("twist.longitudinal")}
    found = ev_sim.batch("shchur2019", vary={"plant.initial_speed": speeds}, metrics=end, duration=0.2)
    for i, speed in enumerate(speeds):
        alone = ev_sim.run("shchur2019", set={"plant.initial_speed": speed}, duration=0.2)
        assert found.metrics["end"][i] == alone.signals["twist.longitudinal"][-1] != 0.0


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"set": {"gamma": 1.0}}, "set: 'gamma' is refused, allowed is NODE.PARAMETER"),
        ({"method": {"asr": "on"}}, "asr: unknown asr method 'on'; known: "),
        ({"vehicle": "audi_a3"}, "unknown vehicle 'audi_a3'; did you mean audi_a2?"),
        ({"runs": ("first",)}, "unknown run of shchur2019 'first'; known: shchur2019"),
    ],
)
def test_what_is_refused_is_one_line(changed, said):
    with pytest.raises(ParameterError) as error:
        ev_sim.run("shchur2019", **changed)
    assert str(error.value).startswith(said)
    assert "\n" not in str(error.value)
