"""FMUs of a car and of a law, run by FMPy: the numbers of the plain run, bit for bit."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import ev_sim
from ev_sim.commands.ev_stack import perform
from ev_sim.fmu.slave import Slave

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "couple_fmus.py"

pytestmark = pytest.mark.slow

CHANGED = ["--set", "electronic_differential.gamma=7.0", "--set", "plant.sensors.imu_yaw_rate.noise=0.01"]
DURATION = 0.5
PERIOD = 0.01


@pytest.fixture(scope="module")
def plain():
    changed = {"electronic_differential.gamma": 7.0, "plant.sensors.imu_yaw_rate.noise": 0.01}
    return ev_sim.run("shchur2019", set=changed, duration=DURATION)


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    """The car but for one law, that law, and the plant with the column alone."""
    folder = tmp_path_factory.mktemp("fmus")
    what = {
        "car": ["--without", "electronic_differential"],
        "law": ["--law", "electronic_differential"],
        "body": [],
    }
    made = {name: folder / f"{name}.fmu" for name in what}
    for name, words in what.items():
        words = [*words, *CHANGED, "--duration", str(DURATION)]
        perform(["fmu", "shchur2019", "--out", str(made[name]), *words])
    return made


def test_car_and_law_coupled_by_fmpy_are_the_plain_run(files, plain, tmp_path):
    """All that the two show, noise as well; in a process of its own, as it is with the tools of others."""
    out = tmp_path / "shown.npz"
    words = [sys.executable, EXAMPLE, files["car"], files["law"], str(DURATION), out]
    done = subprocess.run(words, capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stderr) == (0, "")
    shown = np.load(out)
    asr = {
        name for name in plain.signals if name.startswith("torque_command")
    }  # answers behind the law, so one step late
    assert set(shown) == set(plain.signals) | {"time"}
    for name in set(plain.signals) - asr:
        assert shown[name].tolist() == plain.signals[name].tolist(), name
    for name in asr:
        assert shown[name][1:].tolist() == plain.signals[name][:-1].tolist(), name


def test_the_descriptions_are_valid_and_say_what_is_needed(files):
    assert all(validate_fmu(file) == [] for file in files.values())
    described = fmpy.read_model_description(files["body"])
    assert "needs Python with ev_sim " in described.description
    assert described.coSimulation.canBeInstantiatedOnlyOncePerProcess
    inputs = {v.name.rpartition(".")[0] for v in described.modelVariables if v.causality == "input"}
    assert inputs == {"driver.command", "torque_command.drive", "torque_command.brake"}


@pytest.mark.parametrize(
    ("size", "value", "said"),
    [
        (1.5 * PERIOD, 0.0, "step size 0.015 s is refused, allowed is 0.01 s or a multiple of it"),
        (PERIOD, np.nan, "input torque_request.drive.front_left: nan is refused, allowed is a finite number"),
    ],
)
def test_a_step_that_cannot_be_is_discarded_with_a_line_in_the_log(files, tmp_path, size, value, said):
    """By the class alone, without the binary around it."""
    with zipfile.ZipFile(files["car"]) as packed:
        packed.extract("resources/content.json", tmp_path)
    slave = Slave(instance_name="car", resources=str(tmp_path / "resources"))
    before = slave.get_real(list(slave.vars))
    slave.set_real([0], [value])
    assert not slave.do_step(0.0, size)
    assert [message.msg for message in slave.log_queue] == [said]
    assert slave.get_real(list(slave.vars))[1:] == before[1:]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--out", "9.fmu"], "error: 9.fmu is refused, allowed is NAME.fmu, where NAME is one of a variable in C"),
        (["--law", "brakes"], "error: unknown role 'brakes'; known: "),
        (["--law", "plant"], "error: plant integrates, allowed is one of driver, electronic_differential, asr"),
        (["--without", "asr,tyres"], "error: unknown role 'tyres'; known: "),
    ],
)
def test_wrong_words_get_one_line(words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        perform(["fmu", "shchur2019", "--out", "a.fmu", *words])
    assert str(ended.value).startswith(said)


def test_without_pythonfmu_one_line_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pythonfmu", None)
    with pytest.raises(SystemExit, match=r"^error: pythonfmu cannot be imported .*: pip install 'ev_sim\[fmu\]'$"):
        perform(["fmu", "shchur2019", "--out", str(tmp_path / "a.fmu")])
