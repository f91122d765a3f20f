"""Files with anything in them.

What can be read is in range, anything else is one line that names the file.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from fuzz.fuzzing import assert_one_line, damaged, fuzzed, spoil
from hypothesis import given
from hypothesis import strategies as st

from ev_core.parameters.data_file import RecordingError, config_folders
from ev_msgs_py.refusal import ParameterError
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file
from ev_stack.commands.report import read_folder
from ev_stack.recording.recording import Recording, load, save
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.scenario import Overrides, load_scenario

CONFIG = config_folders()[-1]
YAML = sorted(
    path
    for kind in ("scenarios", "vehicles", "surfaces")
    for path in (CONFIG / kind).glob("*.yaml")
)
CYCLES = sorted((CONFIG / "cycles").glob("*.csv"))
MAPS = sorted((CONFIG / "efficiency_maps").glob("*.csv"))
anything = st.text(max_size=200).map(lambda text: text.encode(errors="replace")) | st.binary(
    max_size=200
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def written(folder: Path, path: Path, damage: tuple[str, int]) -> Path:
    to = folder / path.name
    to.write_bytes(spoil(path.read_bytes(), damage))
    return to


def numbers(values: dict) -> list[float]:
    many = (value if isinstance(value, tuple) else (value,) for value in values.values())
    return [number for several in many for number in several if isinstance(number, float)]


@fuzzed(25, 2.0)
@given(content=anything)
def test_any_text_as_a_parameter_file(folder, content):
    path = folder / "any.yaml"
    path.write_bytes(content)
    try:
        read = ParameterFile(path)
    except ParameterError as refused:
        assert_one_line(refused)
        assert str(path) in str(refused)
    else:
        assert not read.names(), "no text of chance says anything about a node"


@fuzzed(3, 0.5)
@given(path=st.sampled_from(YAML), damage=damaged)
def test_a_damaged_scenario_vehicle_or_parameter_file(folder, path, damage):
    copy = str(written(folder, path, damage))
    scenario = copy if path.parent.name == "scenarios" else "shchur2019"
    overrides = Overrides(
        files=[Path(copy)] if path.parent.name == "surfaces" else (),
        vehicle=copy if path.parent.name == "vehicles" else None,
    )
    try:
        runs = load_scenario(scenario, overrides).runs
    except ParameterError as error:
        assert_one_line(error)
        return
    for run in runs:
        assert 0.0 < run.duration < 1e5
        assert all(
            math.isfinite(x) for c in run.configurations.values() for x in numbers(c.values())
        )


@fuzzed(20, 1.5)
@given(path=st.sampled_from(CYCLES), damage=damaged)
def test_a_damaged_cycle(folder, path, damage):
    copy = written(folder, path, damage)
    try:
        made = with_profile_from_file(SpeedProfileParameters(file=str(copy)))
    except ParameterError as error:
        assert_one_line(error)
        assert str(copy) in str(error)
        return
    assert len(made.time) == len(made.speed) > 0
    assert all(math.isfinite(number) for number in (*made.time, *made.speed))
    assert all(earlier < later for earlier, later in zip(made.time, made.time[1:], strict=False))


@fuzzed(1, 0.1)
@given(path=st.sampled_from(MAPS), damage=damaged)
def test_a_damaged_efficiency_map(folder, path, damage):
    copy = written(folder, path, damage)
    values = [("*", "vehicle.motor.map_file", str(copy))]
    try:
        (run,) = load_scenario("coast_down", Overrides(values=values)).runs
    except ParameterError as error:
        assert_one_line(error)
        return
    assert all(math.isfinite(x) for c in run.configurations.values() for x in numbers(c.values()))


@pytest.fixture(scope="module")
def left_behind(tmp_path_factory) -> tuple[bytes, bytes]:
    """signals.npz and summary.json, as short as they get."""
    path = tmp_path_factory.mktemp("run") / "signals.npz"
    save(Recording(np.arange(3.0), {"pose.x": np.arange(3.0)}), path)
    summary = {
        "scenario": "coast_down",
        "runs": {"coast_down": {}},
        "vehicle": {"vehicle.mass": 1000.0},
        "hash": "0",
    }
    return path.read_bytes(), json.dumps(summary).encode()


@fuzzed(30, 1.5)
@given(damage=damaged)
def test_damaged_signals(folder, left_behind, damage):
    path = folder / "signals.npz"
    path.write_bytes(spoil(left_behind[0], damage))
    try:
        recording = load(path)
    except RecordingError as error:
        assert_one_line(error)
        assert str(path) in str(error)
        return
    assert all(
        values.dtype == np.float64 and len(values) == len(recording.time)
        for values in recording.channels.values()
    )


@fuzzed(30, 1.0)
@given(damage=damaged)
def test_a_damaged_summary(folder, left_behind, damage):
    (folder / "signals.npz").write_bytes(left_behind[0])
    (folder / "summary.json").write_bytes(spoil(left_behind[1], damage))
    try:
        read_folder("run", folder)
    except ParameterError as error:
        assert_one_line(error)
        assert str(folder) in str(error)
