"""Recorded inputs into a role: as recorded it says the same bits, and what differs is found where it begins."""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import RECORDED, ROLES
from ev_msgs_py.contract.shape import SignalError
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.commands.replay import run_replay
from ev_sim.commands.run_scenario import main
from ev_sim.replay.comparing import differences_of, in_words
from ev_sim.replay.graph import replay_of
from ev_sim.replay.latency import latency_of
from ev_sim.replay.outputs import replay_folder
from ev_sim.replay.recorded import Recorded, find_recorded
from ev_sim.running.offline import drive_offline, run_offline
from ev_sim.running.recording.message_table import MessageTable
from ev_sim.running.recording.recording import Recording, load, save, signal_hash
from ev_sim.running.recording.run_recorder import RunRecorder
from ev_sim.running.scenarios.scenario import Overrides, load_scenario

ROOT = Path(__file__).parents[2]
PERIOD = 10_000_000  # ns, of shchur2019
STEERED = 10.0  # s, at which the driver of shchur2019 takes the wheel


@pytest.fixture(scope="module")
def turn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Power steering up to the first turn, without a bag."""
    out = tmp_path_factory.mktemp("turn")
    main(["shchur2019", "--offline", "--duration", "11", "--no-report", "--no-record", "--out", str(out)])
    return out


def differences(recorded: Recorded, out: Path, role: str, method: str = "", duration: float | None = None):
    replay = replay_of(recorded, role, method, Overrides(duration=duration))
    run, _ = replay_folder(replay, out)
    return differences_of(replay, drive_offline(run).recording)


def test_another_law_differs_from_the_step_in_which_hands_or_column_move(
    turn: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """Eq 4 of Shchur (2019) gives no torque difference as long as hand torque, angle and rate are zero."""
    run_replay([str(turn), "--node", "electronic_differential=equal_torque", "--out", str(tmp_path)])
    channels = load(turn / "signals.npz").channels
    moved = np.zeros(len(channels["imu.yaw_rate"]), bool)
    for field in ("hand_torque", "angle", "rate"):
        moved |= channels[f"steering_column.state.{field}"] != 0.0
    with (tmp_path / "table.csv").open() as file:
        rows = {row["channel"]: row for row in csv.DictReader(file)}
    left = rows["torque_request.drive.front_left"]
    step = int(left["step"])
    assert step == np.flatnonzero(moved)[0] and float(left["time"]) == pytest.approx(step * 0.01)
    assert float(left["time"]) >= STEERED
    replayed = load(tmp_path / "replayed" / "signals.npz").channels["torque_request.drive.front_left"]
    apart = np.abs(replayed - channels["torque_request.drive.front_left"])
    assert float(left["largest"]) == apart.max() and apart[round(float(left["at"]) * 100)] == apart.max()
    assert float(left["rms"]) == pytest.approx(np.sqrt(np.mean(apart**2)))
    assert rows["torque_request.brake.rear_left"]["differing"] == "0"
    said = capsys.readouterr().out
    assert "2 of 8 channels differ, compared at 1101 instants; first torque_request.drive.front_left in step" in said
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["runs"]["recorded"]["signal_hash"] != summary["runs"]["replayed"]["signal_hash"]
    assert summary["differences"][0]["step"] == step
    page = (tmp_path / "report.html").read_text()
    assert "torque_request.drive.front_left" in page and "2 of 8 channels differ" in page


def realtime_bag(of: Recording, folder: Path, lost: dict[str, int]) -> Path:
    """A folder with a bag as the recorder writes it in real time; `lost`: of which topics one instant is missing.

    All of it is 20 ms late, the driver 2 ms after the plant, and so on.
    """
    after = {"driver/command": 2, "torque_request": 3, "torque_command": 4, "steering_column/state": -1}  # ms
    topics = [TOPICS[s] for s in RECORDED if set(TOPICS[s].channels) <= set(of.channels)]
    recorder = RunRecorder(topics, [f"/ev/{t.name}" for t in topics], PERIOD, folder / "bag", may_skip=True)
    frames = frame.stack(len(of.time), PERIOD)
    for topic in topics:
        frames[:, frame.PLACES[topic.signal]] = np.stack([of.channels[name] for name in topic.channels], axis=1)
    at = np.arange(len(of.time)) * PERIOD
    messages = [MessageTable(topic).serialize(at, frames) for topic in topics]
    for step in range(len(of.time)):
        for index, topic in enumerate(topics):
            if lost.get(topic.name) != step:
                late = 20 + after.get(topic.name, 0)
                recorder.add(index, messages[index][step], 10**18 + int(at[step]) + late * 1_000_000)
    recorder.close()
    return folder


def test_bag_in_real_time_keeps_arrivals_and_compares_where_both_sides_are_known(turn: Path, tmp_path: Path):
    folder = realtime_bag(load(turn / "signals.npz"), tmp_path, {"torque_request": 1050, "driver/command": 1060})
    shutil.copy(turn / "parameters.yaml", folder)
    recorded = find_recorded(folder)
    assert [note.partition(" of")[0] for note in recorded.notes] == [
        "driver/command: 1", "torque_request: 1"
    ]  # fmt: skip
    found = differences(recorded, tmp_path / "out", "electronic_differential")
    assert {each.compared for each in found} == {1101 - 2} and in_words(found).startswith("bit-identical")
    timing = latency_of(recorded)
    for topic, expected in (("torque_request", 0.001), ("torque_command", 0.001), ("driver/command", 0.002)):
        assert timing["latency"][topic]["median"] == timing["latency"][topic]["largest"] == pytest.approx(expected)
    # The column answers the driver of the instant before, who is heard 7 ms before it.
    assert timing["latency"]["steering_column/state"]["median"] == pytest.approx(0.007)
    assert sum(timing["jitter"]["torque_request"]["counts"]) == 1100 - 2
    assert timing["jitter"]["wheel_states"]["largest"] == 0.0


def test_role_plays_what_was_recorded_in_any_run(turn: Path):
    def hash_of(*more: tuple, duration: float) -> str:
        values = (("driver", "method", str(turn / "signals.npz")), *more)
        run = load_scenario("shchur2019", Overrides((), values, duration)).runs[0]
        return signal_hash(run_offline(run.configurations, run.duration))

    assert hash_of(duration=11.0) == signal_hash(load(turn / "signals.npz"))
    with pytest.raises(SignalError, match=r"at 11.01 s: driver: .*signals.npz ends at 11 s"):
        hash_of(duration=12.0)
    with pytest.raises(ParameterError, match=r"are none of a control_period of 0.02 s"):
        hash_of(("*", "control_period", 0.02), duration=11.0)
    with pytest.raises(ParameterError, match="a asr says torque_command, none of it is in the file"):
        save(Recording(np.zeros(2), {"mine": np.zeros(2)}), turn / "mine.npz")
        hash_of(("asr", "method", str(turn / "mine.npz")), duration=11.0)


@pytest.fixture(scope="module")
def places(turn: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Of a whole run, and of others that are none."""
    folder = tmp_path_factory.mktemp("places")
    shutil.copy(turn / "signals.npz", folder / "lone.npz")
    (folder / "empty.npz").write_bytes(b"")
    realtime_bag(load(turn / "signals.npz"), folder / "cut", {})
    with (folder / "cut" / "bag" / "bag.mcap").open("r+b") as file:
        file.truncate(2000)
    return {"run": turn, "lone": folder / "lone.npz", "empty": folder / "empty.npz", "cut": folder / "cut"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nothing", "--node", "asr"], "nothing: no such bag"),
        (["{run}", "--node", "asrr"], "unknown node 'asrr'"),
        (["{run}", "--node", "asr=pi"], "--node asr=pi is refused, allowed is a method (acceleration_ratio,"),
        (["{run}", "--node", "asr='x"], 'is refused: No closing quotation'),
        (["{run}", "--node", "test_bench"], "has no bench/load_command, which the test_bench circuits reads; it has "),
        (["{run}", "--node", "asr", "--set", "driver.seed=1"], "driver.seed is refused: driver says what was recorded"),
        (["{run}", "--node", "asr", "--set", "asr.vehicle.mass=1"], "vehicle.mass 1 is refused: 1400.0 was driven"),
        (["{run}", "--node", "asr", "--vehicle", "audi_a2"], "--vehicle audi_a2 is refused: "),
        (["{run}", "--node", "asr", "--duration", "12"], "12.0 is refused, allowed is more than 0 and up to 11.0"),
        (["{run}", "--node", "electronic_differential=slip_target"], "needs rear_left and rear_right"),
        (["{run}/..", "--node", "asr"], "has several runs, allowed is one: "),
        (["{run}/summary.json", "--node", "asr"], "is no recorded run"),
        (["{lone}", "--node", "asr"], "no parameters.yaml beside it says which car it was: --vehicle FILE"),
        (["{empty}", "--node", "asr"], "empty.npz holds no signals: "),
        (["{cut}", "--node", "asr"], "bag: the bag cannot be read: "),
    ],
)  # fmt: skip
def test_what_cannot_be_replayed_is_one_line(words: list[str], said: str, places: dict[str, Path], tmp_path: Path):
    with pytest.raises(SystemExit) as ended:
        main(["replay", *(word.format(**places) for word in words), "--out", str(tmp_path / "out")])
    assert said in ended.value.code and "\n" not in ended.value.code
    assert not (tmp_path / "out").exists()


def test_instants_that_are_not_those_of_a_control_period_are_refused(turn: Path, tmp_path: Path):
    recording = load(turn / "signals.npz")
    again = Recording(recording.time[:300], {name: row[:300] for name, row in recording.channels.items()})
    save(Recording(again.time + 0.003 * (again.time > 1.0), again.channels), tmp_path / "odd.npz")
    with pytest.raises(ParameterError, match="its instants are not those of a control period"):
        find_recorded(tmp_path / "odd.npz")
    with pytest.raises(ParameterError, match="holds 1 whole instants of a run"):
        save(Recording(again.time[:1], {name: row[:1] for name, row in again.channels.items()}), tmp_path / "one.npz")
        find_recorded(tmp_path / "one.npz")


@pytest.mark.slow
def test_as_recorded_every_role_says_the_same_bits(tmp_path: Path):
    """All seven roles, with noise of the sensors and a bus between laws and car, from a bag and from signals.npz."""
    words = [
        "bench_fault",
        "--offline",
        "--duration",
        "0.2",
        "--no-report",
        "--set",
        "plant.sensors.imu_yaw_rate.noise=0.01",
    ]
    main([*words, "--out", str(tmp_path / "run")])
    bag, signals = find_recorded(tmp_path / "run"), find_recorded(tmp_path / "run" / "signals.npz")
    assert bag.source.name == "bag" and not bag.arrivals
    assert set(bag.recording.channels) == set(signals.recording.channels)
    for name, values in signals.recording.channels.items():
        assert np.array_equal(bag.recording.channels[name], values), name
    for role in ROLES:
        found = differences(bag, tmp_path / "out", role)
        written = {name for signal in ROLES[role].writes for name in TOPICS[signal].channels}
        assert {each.channel for each in found} == written & set(bag.recording.channels)
        assert {each.compared for each in found} == {len(bag.recording.time)}
        assert in_words(found).startswith("bit-identical"), role


@pytest.mark.slow
def test_node_of_ones_own_takes_part_in_lockstep(turn: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    command = f"{sys.executable} {ROOT / 'docs' / 'examples' / 'own_node.py'}"
    words = [str(turn), "--node", f"asr={command}", "--duration", "1", "--no-report", "--out", str(tmp_path)]
    run_replay(words)
    assert "bit-identical: 8 channels at 101 instants" in capsys.readouterr().out
