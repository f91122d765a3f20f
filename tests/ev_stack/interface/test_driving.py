"""ev_stack.run and ev_stack.batch: what a notebook calls."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import ev_sim as before
import ev_stack
import ev_study
from ev_doors.learning.environment import Environment
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.observer import last
from ev_stack.commands.run_scenario import main
from ev_stack.interface.driving import overrides
from ev_stack.recording.recording import load, signal_hash

CALLS = [
    ev_stack.run,
    ev_stack.batch,
    ev_stack.Simulation,
    ev_study.compare,
    ev_study.sweep,
    Environment,
]


@pytest.fixture(scope="module")
def result():
    changed = {"electronic_differential.gamma": 4.0, "*.control_period": 0.02}
    return ev_stack.run("shchur2019", method={"asr": "off"}, set=changed, seed=3, duration=1.0)


@pytest.mark.slow
def test_a_run_is_that_of_the_command(result, tmp_path):
    """Both have one hash; all other ways to run have it, too (test_hashes.py, test_machines.py)."""
    words = [
        "--set",
        "electronic_differential.gamma=4.0",
        "--set",
        "*.control_period=0.02",
        "--seed",
        "3",
    ]
    main(
        [
            "shchur2019",
            "--offline",
            "--no-record",
            "--duration",
            "1",
            *words,
            "--out",
            str(tmp_path / "command"),
        ]
    )
    result.save(tmp_path / "saved")
    commanded, saved = (
        json.loads((tmp_path / name / "summary.json").read_text()) for name in ("command", "saved")
    )
    assert commanded["signal_hash"] == saved["signal_hash"] == result.hash
    for of_run in ("wall_time", "real_time_factor", "command"):
        del commanded[of_run], saved[of_run]
    assert commanded == saved
    assert (
        signal_hash(load(tmp_path / "saved" / "signals.npz"))
        == saved["runs"]["shchur2019"]["signal_hash"]
    )
    names = [
        sorted(path.name for path in (tmp_path / name).glob("*.png"))
        for name in ("command", "saved")
    ]
    assert names[0] == names[1] != []


def test_signals_are_arrays_over_time(result):
    assert result.time.tolist() == pytest.approx(np.arange(0.0, 1.01, 0.02).tolist())
    assert result.signals["twist.longitudinal"].shape == result.time.shape
    assert {"m/s", "rad"} <= {metric.unit for metric in result.metrics.values()}
    assert result._repr_html_().count("<img ") == 1


def test_everything_that_a_program_calls_is_listed_before_it_is_imported():
    """A Python of its own shows it: here all of it is imported already."""
    code = "import sys, ev_stack; print(*dir(ev_stack)); assert 'ev_stack.interface' not in sys.modules"
    shown = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout.split()
    assert {
        "run",
        "batch",
        "Simulation",
        "Result",
        "BatchResult",
        "ParameterError",
        "SignalError",
    } <= {*shown}
    assert all(hasattr(ev_stack, name) for name in shown)
    assert sorted(ev_stack.__all__) == [name for name in shown if not name.startswith("_")]
    with pytest.raises(AttributeError, match=r"^module 'ev_stack' has no attribute 'runs'$"):
        _ = ev_stack.runs


def test_what_has_moved_from_ev_sim_is_there_with_one_line():
    with pytest.warns(FutureWarning, match=r"^ev_sim\.run is ev_stack\.run now: import ev_stack$"):
        assert before.run is ev_stack.run
    with pytest.raises(AttributeError, match=r"^module 'ev_sim' has no attribute 'runs'$"):
        _ = before.runs


def test_a_run_and_its_metrics_take_what_is_compiled_without_the_compiler():
    """A run and its metrics do not import numba, which takes longer, nor matplotlib."""
    lane_change = ev_stack.run("double_lane_change", duration=0.1)
    # a Python of its own finds all of it compiled
    assert lane_change.metrics["course_passed"].reason
    code = "import sys, ev_stack; ev_stack.run('double_lane_change', duration=0.1).metrics; print({'numba', 'matplotlib'} & {*sys.modules})"
    assert (
        subprocess.run(
            [sys.executable, "-c", code], check=True, capture_output=True, text=True
        ).stdout
        == "set()\n"
    )


@pytest.mark.parametrize("call", CALLS)
def test_a_keyword_that_is_none_is_refused_with_the_one_that_is_meant(call):
    with pytest.raises(TypeError, match=r"^unknown keyword 'metod'; did you mean method\b"):
        call("shchur2019", metod={"asr": "off"})


@pytest.mark.parametrize("call", CALLS)
def test_what_may_be_changed_can_be_completed(call):
    """The same words in every call, all by name, each with its type."""
    found = inspect.signature(call).parameters
    changed = {
        name: each.annotation
        for name, each in found.items()
        if each.kind is inspect.Parameter.KEYWORD_ONLY
    }
    overridden = inspect.signature(overrides).parameters
    assert changed == {name: each.annotation for name, each in overridden.items()}
    assert not {inspect.Parameter.VAR_KEYWORD} & {each.kind for each in found.values()}


def test_a_result_is_shown_in_a_few_lines(result):
    lines = repr(result).splitlines()
    assert lines[0] == f"Result of shchur2019, offline, signal hash {result.hash[:12]}"
    measured = [name for name, metric in result.metrics.items() if metric.value is not None]
    assert [line.split()[0] for line in lines[1:-1]] == measured[: len(lines) - 2] != []
    assert lines[-1] == f"  and {len(result.metrics) - len(lines) + 2} more in .metrics"
    assert repr(result.runs) == "{'shchur2019': Recording of 54 channels at 51 instants in 1 s}"


def pandas_frame(monkeypatch, of) -> SimpleNamespace:
    """The columns and the index that pandas, which the environment lacks, would be given."""
    frame = SimpleNamespace(attrs={})
    pandas = SimpleNamespace(
        DataFrame=lambda columns, index: vars(frame).update(columns=columns, index=index) or frame
    )
    pandas.Index = lambda values, name: (values, name)
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    assert of.data_frame() is frame
    return frame


def test_a_batch_as_a_data_frame_has_what_varied_beside_the_metrics(monkeypatch):
    """A row for each run, and the units of all columns."""
    found = ev_stack.batch(
        "shchur2019",
        {"plant.initial_speed": np.array([2.0, 8.0]), "*.seed": range(2)},
        metrics=["final_speed", "x [m] = last(pose.x)"],
        duration=0.1,
    )
    frame = pandas_frame(monkeypatch, found)
    assert {name: list(values) for name, values in frame.columns.items()} == {
        "plant.initial_speed": [2.0, 8.0],
        "*.seed": [0, 1],
        "final_speed": list(found.metrics["final_speed"]),
        "x": list(found.metrics["x"]),
        "end": [0.1, 0.1],
    }
    units = {"plant.initial_speed": "m/s", "*.seed": "", "final_speed": "m/s", "x": "m"}
    assert frame.attrs["units"] == {**units, "end": "s"}
    assert frame.index is None
    reduced = ev_stack.batch("shchur2019", metrics={"top": last("imu.yaw_rate")}, duration=0.1)
    assert pandas_frame(monkeypatch, reduced).attrs["units"]["top"] == "rad/s"


def test_a_data_frame_has_the_units_of_its_columns(result, monkeypatch):
    frame = pandas_frame(monkeypatch, result)
    units = frame.attrs["units"]
    assert units["imu.yaw_rate"] == "rad/s" and units["torque_command.drive.rear_left"] == "N m"
    assert {*units} == {*frame.columns, frame.index[1]} and units["time"] == "s"


def test_a_data_frame_needs_pandas(result, monkeypatch):
    """It is no requirement of the packages, but an extra, which the error names."""
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install .ev_stack\[frame\]"):
        result.data_frame()


def test_of_several_runs_one_is_named():
    both = ev_stack.run("shchur2019_steps", runs=("object", "hold_manual"), duration=0.02)
    assert list(both.runs) == ["object", "hold_manual"]
    with pytest.raises(
        ParameterError,
        match=r"^shchur2019_steps has several runs: runs\[NAME\] of object, hold_manual$",
    ):
        _ = both.signals


def test_a_scenario_of_ones_own_brings_its_metrics(tmp_path):
    path = tmp_path / "mine.yaml"
    about = "{about: mine, duration: 0.1, metrics: ['v = last(twist.longitudinal)']}"
    path.write_text(
        f"/**/scenario:\n  ros__parameters: {about}\n/**/plant:\n  ros__parameters: {{initial_speed: 5.0}}\n"
    )
    found = ev_stack.run(path).metrics
    assert found["v"].value == found["final_speed"].value != 0.0
    assert found["v"].unit == "m/s"


def test_a_batch_is_the_runs_one_by_one():
    speeds = [2.0, 8.0]
    end = {"end": last("twist.longitudinal")}
    found = ev_stack.batch(
        "shchur2019", vary={"plant.initial_speed": speeds}, metrics=end, duration="200 ms"
    )
    assert repr(found) == "BatchResult of end (2,); 0 failed"
    assert (
        repr(replace(found, metrics={}))
        == "BatchResult of nothing, as neither metrics nor signals were named; 0 failed"
    )
    for i, speed in enumerate(speeds):
        alone = ev_stack.run("shchur2019", set={"plant.initial_speed": speed}, duration=0.2)
        assert found.metrics["end"][i] == alone.signals["twist.longitudinal"][-1] != 0.0


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"set": {"gamma": 1.0}}, "set: 'gamma' is refused, expected NODE.PARAMETER"),
        ({"method": {"asr": "on"}}, "asr: unknown asr method 'on'; known: "),
        ({"vehicle": "audi_a3"}, "unknown vehicle 'audi_a3'; did you mean audi_a2?"),
        (
            {"duration": "5"},
            "duration: '5' is refused, expected a number of seconds or such as '5 s'",
        ),
        (
            {"duration": [5.0]},
            "duration: [5.0] is refused, expected a number of seconds or such as '5 s'",
        ),
        ({"runs": ("first",)}, "unknown run of shchur2019 'first'; known: shchur2019"),
    ],
)
def test_what_is_refused_is_one_line(changed, message):
    with pytest.raises(ParameterError) as error:
        ev_stack.run("shchur2019", **changed)
    assert str(error.value).startswith(message)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "call",
    [
        lambda: ev_stack.run("a\0.yaml"),
        *(
            lambda name=name: ev_stack.run("shchur2019", **{name: "a\0.csv"})
            for name in ("vehicle", "cycle")
        ),
        lambda: ev_stack.run("shchur2019", params=["a\0.yaml"]),
        *(
            lambda end=end: ev_stack.run("shchur2019", method={"asr": f"a\0{end}"})
            for end in (".py", ".so", ".npz")
        ),
        lambda: ev_stack.run("shchur2019", duration=0.05).save("/tmp/a\0b"),
    ],
)
def test_a_null_byte_in_a_path_is_one_line(call):
    """The line shows the path, in which the byte can be found."""
    with pytest.raises(ParameterError, match=r"a\\x00"):
        call()
