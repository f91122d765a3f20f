"""scripts/run.sh: the same numbers in every way of running, clean ends, one line for bad input."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from helpers.patience import wait_until
from helpers.run_script import ENVIRONMENT, ROOT, RUN, Running
from rosbags.highlevel import AnyReader

from ev_nodes.node_loop.ordinary_steps import VARIABLE
from ev_stack.recording.recording import load

pytestmark = pytest.mark.slow


def run(*arguments: object, check: bool = True) -> subprocess.CompletedProcess:
    """Run the script to its end."""
    words = [RUN, *map(str, arguments)]
    return subprocess.run(words, env=ENVIRONMENT, check=check, capture_output=True, text=True)


def summary(folder: Path) -> dict:
    return json.loads((folder / "summary.json").read_text())


def messages_in(bag: Path) -> dict[str, int]:
    """Number of messages by topic, all of them read."""
    counts: dict[str, int] = {}
    with AnyReader([bag]) as reader:
        for connection, _, _ in reader.messages():
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
    return counts


def shown_in(bag: Path) -> dict[str, list[bytes]]:
    """Views of a run, to the last bit."""
    found: dict[str, list[bytes]] = {
        "/tf": [],
        "/tf_static": [],
        "/ev/odometry": [],
        "/ev/robot_description": [],
    }
    with AnyReader([bag]) as reader:
        for connection, _, data in reader.messages():
            if connection.topic in found:
                found[connection.topic].append(bytes(data))
    return found


@contextmanager
def both_cores_busy() -> Iterator[None]:
    hogs = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(os.cpu_count() or 2)
    ]
    try:
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()


@pytest.fixture(scope="module")
def offline(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of 3 s without DDS."""
    folder = tmp_path_factory.mktemp("offline")
    run("shchur2019", "--duration", 3, "--offline", "--out", folder)
    return folder


@pytest.mark.parametrize("loop", ["1", "0"], ids=["compiled loop", "loop in Python"])
@pytest.mark.parametrize("way", [(), ("--in-process",)], ids=["dds", "one"])
@pytest.mark.sampled
def test_every_way_of_running_gives_the_same_signals(
    way: tuple[str, ...], loop: str, offline: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Signals agree bit by bit: a hash that forgets a channel would be noticed."""
    monkeypatch.setitem(ENVIRONMENT, VARIABLE, loop)
    run("shchur2019", "--duration", 3, "--no-report", *way, "--out", tmp_path)
    assert summary(tmp_path)["signal_hash"] == summary(offline)["signal_hash"]
    ours, theirs = load(tmp_path / "signals.npz"), load(offline / "signals.npz")
    assert ours.channels.keys() == theirs.channels.keys()
    assert all(np.array_equal(ours.channels[name], theirs.channels[name]) for name in ours.channels)
    assert messages_in(tmp_path / "bag").items() >= messages_in(offline / "bag").items()
    assert shown_in(tmp_path / "bag") == shown_in(offline / "bag")


@pytest.mark.weekly
def test_the_same_signals_while_both_cores_are_busy(offline: Path, tmp_path: Path):
    with both_cores_busy():
        run("shchur2019", "--duration", 3, "--no-record", "--no-report", "--out", tmp_path)
    assert summary(tmp_path)["signal_hash"] == summary(offline)["signal_hash"]


def test_what_a_run_leaves_behind(offline: Path):
    content = summary(offline)
    assert content["scenario"] == "shchur2019"
    assert content["mode"] == "offline"
    assert content["methods"]["electronic_differential"] == "power_steering"
    assert content["reproducible"] is True
    assert content["simulated_time"] == 3.0
    assert {"value", "unit", "reference", "band", "verdict"} <= content["metrics"][
        "shchur.fig4.dV.left"
    ].keys()
    recording = load(offline / "signals.npz")
    assert len(recording.time) == 301
    assert messages_in(offline / "bag")["/ev/wheel_states"] == 301
    assert list(offline.glob("*.png"))


def test_options_reach_the_nodes(tmp_path: Path):
    more = tmp_path / "more.yaml"
    more.write_text(
        "/**/driver:\n  ros__parameters:\n    speed_control: {proportional_gain: 1500.0}\n"
    )
    out = tmp_path / "out"
    words = (
        "--method",
        "electronic_differential=equal_torque",
        "--set",
        "plant.drive=averaged",
        "--seed",
        "7",
    )
    short = ("--offline", "--duration", 1, "--no-record", "--no-report")
    run("shchur2019", *short, "--params", more, *words, "--out", out)
    content = summary(out)
    assert content["methods"]["electronic_differential"] == "equal_torque"
    assert content["parameters"]["plant"]["drive"] == "averaged"
    assert content["parameters"]["driver"]["speed_control.proportional_gain"] == 1500.0
    assert content["seed"] == 7
    assert not (out / "bag").exists()


def test_a_closed_output_is_no_error():
    """The reader may be gone before the first word: `scripts/run.sh --list | head`."""
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(
        [RUN, "--list"], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert ended.stderr == "" and ended.returncode == 141


def test_list_names_scenarios_and_methods():
    output = run("--list").stdout
    for name in (
        "shchur2019",
        "shchur2019_steps",
        "power_steering",
        "steer_by_wire",
        "drive_by_wire",
        "kinematic",
    ):
        assert re.search(rf"^  {name} +\S", output, re.MULTILINE), name


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("shchur2020",),
            "unknown scenario, study or review 'shchur2020'; did you mean shchur2019",
        ),
        (
            ("shchur2019", "--method", "driver=robot"),
            "unknown driver method 'robot'; known: .*speed_profile",
        ),
        (("shchur2019", "--method", "engine=off"), "unknown node 'engine'; known: .*plant"),
        (
            ("shchur2019", "--set", "plant.drvie=ideal"),
            "unknown parameter of plant 'drvie'; did you mean drive",
        ),
        (
            ("shchur2019", "--set", "plant.drive=steam"),
            "drive: 'steam' is refused, expected one of .*ideal",
        ),
        (
            ("shchur2019", "--set", "electronic_differential.gamma=-1"),
            "gamma: -1.0 is refused, expected 0 to 50",
        ),
        (
            ("shchur2019", "--set", "driver.speed_control.proportional_gain=nan"),
            "proportional_gain: 'nan' is refused",
        ),
        (
            ("shchur2019", "--set", "plantdrive"),
            "--set 'plantdrive' is refused, expected NODE.PARAM=VALUE",
        ),
        (("shchur2019", "--params", "/nowhere.yaml"), "/nowhere.yaml: No such file"),
        (("shchur2019", "--duration", "-1"), "duration: -1.0 is refused"),
    ],
)
def test_bad_input_is_one_line_and_a_status(
    arguments: tuple[str, ...], message: str, tmp_path: Path
):
    """The line has place, value and what is expected.

    No files are left of a run that never began.
    """
    out = tmp_path / "out"
    result = run(*arguments, "--offline", "--out", out, check=False)
    assert result.returncode != 0
    assert re.search(message, result.stderr)
    assert len(result.stderr.strip().splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("variable", "value", "message"),
    [
        (
            "ROS_AUTOMATIC_DISCOVERY_RANGE",
            "OFF",
            "no node would find another one, expected LOCALHOST or SUBNET",
        ),
        ("RMW_IMPLEMENTATION", "rmw_of_nobody", "expected one that is installed, or none"),
    ],
)
def test_where_no_node_can_hear_another_a_run_is_refused_in_one_line(
    variable, value, message, tmp_path: Path
):
    words = [RUN, "shchur2019", "--duration", "0.1", "--out", tmp_path / "out"]
    ended = subprocess.run(
        words, env={**ENVIRONMENT, variable: value}, capture_output=True, text=True
    )
    assert ended.returncode == 1
    (line,) = [line for line in re.split("[\r\n]+", ended.stderr) if "error" in line.lower()]
    assert line.startswith(f"error: {variable}=") and line.endswith(message)


@pytest.mark.parametrize("name", ["run.sh", "setup.sh", "inspect.sh"])
def test_a_script_is_found_through_a_link_and_whatever_cdpath_says(name: str, tmp_path: Path):
    """`cd scripts` leads to the first folder of that name in CDPATH, and says so."""
    (tmp_path / "scripts").mkdir()
    (tmp_path / "link").symlink_to(RUN.parent / name)
    environment = {**ENVIRONMENT, "CDPATH": str(tmp_path)}
    for script, folder in (("./link", tmp_path), (f"scripts/{name}", RUN.parents[1])):
        ended = subprocess.run(
            [script, "--help"], cwd=folder, env=environment, capture_output=True, text=True
        )
        assert (ended.returncode, ended.stderr) == (0, "")
        assert str(tmp_path) not in ended.stdout


@pytest.mark.weekly
def test_warnings_of_other_packages_end_no_run(tmp_path: Path):
    words = [
        RUN,
        "shchur2019",
        "--in-process",
        "--duration",
        "0.1",
        "--no-record",
        "--no-report",
        "--out",
        tmp_path,
    ]
    subprocess.run(
        words, env={**ENVIRONMENT, "PYTHONWARNINGS": "error"}, check=True, capture_output=True
    )


def test_nothing_that_a_shell_has_started_outlives_a_runner_that_is_killed(tmp_path: Path):
    """A shell that starts a node hands on no death signal."""
    node = ROOT / "docs" / "examples" / "own_node.py"
    running = Running(tmp_path / "out", "--node", f"asr=sh -c 'python {node} \"$@\"; true' sh")
    (runner,) = [pid for pid, words in running.processes().items() if "ev-stack run" in words]
    os.kill(runner, signal.SIGKILL)
    assert running.end() != 0
    wait_until(lambda: not running.processes(), about=running.processes)


def test_broken_yaml_is_named_with_its_line(tmp_path: Path):
    broken = tmp_path / "broken.yaml"
    broken.write_text("/**/driver:\n  ros__parameters: {a: [1,\n")
    result = run(
        "shchur2019", "--offline", "--params", broken, "--out", tmp_path / "out", check=False
    )
    assert result.returncode != 0
    assert re.search(r"broken\.yaml: not readable as YAML in line \d", result.stderr)


@pytest.mark.parametrize(
    "name",
    ["plant", *(pytest.param(name, marks=pytest.mark.weekly) for name in ("asr", "recorder"))],
)
def test_killing_a_node_ends_the_run_and_leaves_nothing(name: str, tmp_path: Path):
    """One of each kind. How soon the run ends, the failure campaign measures."""
    running = Running(tmp_path / "out")
    os.kill(running.node(name), signal.SIGKILL)
    assert running.end() != 0
    (line,) = [line for line in running.text().splitlines() if "error:" in line]
    assert f"node {name} was killed by SIGKILL" in line
    assert running.left_behind() == ({}, set())
    counts = messages_in(running.folder / "bag")
    assert counts["/ev/wheel_states"] > 50


def test_a_node_that_hangs_is_named_and_the_run_waits_for_it(tmp_path: Path):
    """A node that the kernel has stopped may go on, so the run does not end by itself."""
    running = Running(tmp_path / "out", "--set", "plant.answer_timeout=1.0")
    hanging = running.node("electronic_differential")
    os.kill(hanging, signal.SIGSTOP)

    def is_named() -> bool:
        assert running.script.poll() is None, running.text()
        return "stopped by a signal: electronic_differential" in running.text()

    wait_until(is_named, about=running.text)
    os.kill(hanging, signal.SIGCONT)
    os.killpg(running.script.pid, signal.SIGINT)
    assert running.end() == 130
    assert running.left_behind() == ({}, set())


@pytest.mark.parametrize("way", [("--offline",), ()], ids=["offline", "dds"])
def test_where_nothing_more_can_be_written_the_run_ends_in_one_line(
    way: tuple[str, ...], tmp_path: Path
):
    """No file may grow beyond 30 kB here; a full disk says another word in the same places."""
    words = [RUN, "shchur2019", *way, "--duration", "2", "--no-report", "--out", tmp_path / "out"]
    ended = subprocess.run(
        words,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000)),
    )
    assert ended.returncode == 1, ended.stderr
    lines = [line for line in re.split("[\r\n]+", ended.stderr) if "error" in line.lower()]
    assert len(lines) == 1 and lines[0].startswith("error: ") and "File too large" in lines[0], (
        ended.stderr
    )
    assert "Traceback" not in ended.stderr


@pytest.mark.weekly
def test_ctrl_c_stops_everything(tmp_path: Path):
    running = Running(tmp_path / "out")
    os.killpg(running.script.pid, signal.SIGINT)
    assert running.end() == 130
    assert "Traceback" not in running.text()
    assert running.left_behind() == ({}, set())
    assert messages_in(running.folder / "bag")["/ev/wheel_states"] > 50


def test_realtime_takes_its_time_and_says_that_it_is_not_reproducible(tmp_path: Path):
    run(
        "shchur2019",
        "--realtime",
        "--in-process",
        "--duration",
        1,
        "--no-report",
        "--out",
        tmp_path,
    )
    content = summary(tmp_path)
    assert content["reproducible"] is False
    # By the wall clock, and never faster; not counted is what goes by until the recorder knows the
    # others by name.
    assert content["wall_time"] > 0.7
    assert content["timing"]["shchur2019"]["steps"] == 100


@pytest.mark.parametrize(
    "way", [pytest.param((), marks=pytest.mark.weekly), ("--in-process",)], ids=["dds", "one"]
)
def test_sigterm_stops_everything_too(way: tuple[str, ...], tmp_path: Path):
    """`timeout` and a cancelled job send it to the script only, not to its nodes."""
    running = Running(tmp_path / "out", *way)
    running.script.send_signal(signal.SIGTERM)
    assert running.end() == 130
    assert running.text().endswith("stopped\n") and "Traceback" not in running.text()
    assert running.left_behind() == ({}, set())
    assert len(load(running.folder / "signals.npz").time) > 50


@pytest.mark.weekly
@pytest.mark.parametrize("name", ["plant", "recorder"])
def test_a_node_that_is_stopped_ends_the_run(name: str, tmp_path: Path):
    """It ends with status 0, as these two do at the end of a run."""
    running = Running(tmp_path / "out")
    os.kill(running.node(name), signal.SIGTERM)
    assert running.end() == 1
    assert re.search(
        rf"error: node {name} was stopped, at [\d.]+ s of simulated time$", running.text()
    )
    assert running.left_behind() == ({}, set())
