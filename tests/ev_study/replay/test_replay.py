"""Recorded inputs into a role.

As recorded it says the same bits, and what differs is found where it begins.
"""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from replay.bags import differences, realtime_bag

from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, load, save, signal_hash
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.commands.replay import run_replay
from ev_study.replay.comparing import in_words
from ev_study.replay.recorded import find_recorded

ROOT = Path(__file__).parents[3]
STEERED = 10.0  # s, at which the driver of shchur2019 takes the wheel


def test_another_law_differs_from_the_step_in_which_hands_or_column_move(
    turn: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """Eq 4 of Shchur (2019) gives no difference while hand torque, angle and rate are zero."""
    run_replay(
        [str(turn), "--node", "electronic_differential=equal_torque", "--out", str(tmp_path)]
    )
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
    replayed = load(tmp_path / "replayed" / "signals.npz").channels[
        "torque_request.drive.front_left"
    ]
    apart = np.abs(replayed - channels["torque_request.drive.front_left"])
    assert (
        float(left["largest"]) == apart.max()
        and apart[round(float(left["at"]) * 100)] == apart.max()
    )
    assert float(left["rms"]) == pytest.approx(np.sqrt(np.mean(apart**2)))
    assert rows["torque_request.brake.rear_left"]["differing"] == "0"
    output = capsys.readouterr().out
    assert (
        "2 of 8 channels differ, compared at 1101 instants; first torque_request.drive.front_left in step"
        in output
    )
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["runs"]["recorded"]["signal_hash"] != summary["runs"]["replayed"]["signal_hash"]
    assert summary["differences"][0]["step"] == step
    page = (tmp_path / "report.html").read_text()
    assert "torque_request.drive.front_left" in page and "2 of 8 channels differ" in page


def test_role_plays_what_was_recorded_in_any_run(turn: Path, tmp_path: Path):
    def hash_of(*more: tuple, duration: float) -> str:
        values = (("driver", "method", str(turn / "signals.npz")), *more)
        run = load_scenario("shchur2019", Overrides((), values, duration)).runs[0]
        return signal_hash(run_offline(run.configurations, run.duration))

    assert hash_of(duration=11.0) == signal_hash(load(turn / "signals.npz"))
    with pytest.raises(SignalError, match=r"at 11.01 s: driver: .*signals.npz ends at 11 s"):
        hash_of(duration=12.0)
    with pytest.raises(ParameterError, match=r"are none of a control_period of 0.02 s"):
        hash_of(("*", "control_period", 0.02), duration=11.0)
    with pytest.raises(
        ParameterError, match="a asr writes torque_command, none of it is in the file"
    ):
        save(Recording(np.zeros(2), {"mine": np.zeros(2)}), tmp_path / "mine.npz")
        hash_of(("asr", "method", str(tmp_path / "mine.npz")), duration=11.0)


@pytest.fixture(scope="module")
def places(turn: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Places of a whole run, and of others that are none."""
    folder = tmp_path_factory.mktemp("places")
    shutil.copy(turn / "signals.npz", folder / "lone.npz")
    (folder / "empty.npz").write_bytes(b"")
    realtime_bag(load(turn / "signals.npz"), folder / "cut", {})
    with (folder / "cut" / "bag" / "bag.mcap").open("r+b") as file:
        file.truncate(2000)
    return {
        "run": turn,
        "lone": folder / "lone.npz",
        "empty": folder / "empty.npz",
        "cut": folder / "cut",
    }


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nothing", "--node", "asr"], "nothing: no such bag"),
        (["{run}", "--node", "asrr"], "unknown node 'asrr'"),
        (["{run}", "--node", "asr=pi"], "--node asr=pi is refused, expected a method (acceleration_ratio,"),
        (["{run}", "--node", "asr='x"], 'is refused: No closing quotation'),
        (["{run}", "--node", "test_bench"], "has no bench/load_command, which the test_bench circuits reads; it has "),
        (["{run}", "--node", "asr", "--set", "driver.seed=1"], "driver.seed is refused: driver says what was recorded"),
        (["{run}", "--node", "asr", "--set", "asr.vehicle.mass=1"], "vehicle.mass 1 is refused: 1400.0 was driven"),
        (["{run}", "--node", "asr", "--vehicle", "audi_a2"], "--vehicle audi_a2 is refused: "),
        (["{run}", "--node", "asr", "--duration", "12"], "12.0 is refused, expected more than 0 and up to 11.0"),
        (["{run}", "--node", "electronic_differential=slip_target"], "needs rear_left and rear_right"),
        (["{run}/..", "--node", "asr"], "has several runs, expected one: "),
        (["{run}/summary.json", "--node", "asr"], "is no recorded run"),
        (["{lone}", "--node", "asr"], "no parameters.yaml beside it says which car it was: --vehicle FILE"),
        (["{empty}", "--node", "asr"], "empty.npz holds no signals: "),
        (["{cut}", "--node", "asr"], "bag: the bag cannot be read: "),
    ],
)  # fmt: skip
def test_what_cannot_be_replayed_is_one_line(
    words: list[str], message: str, places: dict[str, Path], tmp_path: Path
):
    with pytest.raises(SystemExit) as ended:
        main(["replay", *(word.format(**places) for word in words), "--out", str(tmp_path / "out")])
    assert message in ended.value.code and "\n" not in ended.value.code
    assert not (tmp_path / "out").exists()


def test_a_recorded_answer_that_is_no_number_is_refused(turn: Path, tmp_path: Path):
    """It would differ from the replayed one by no number."""
    channels = dict(load(turn / "signals.npz").channels)
    name = "torque_command.drive.front_left"
    channels[name] = np.where(np.arange(len(channels[name])) == 7, np.nan, channels[name])
    save(Recording(load(turn / "signals.npz").time, channels), tmp_path / "signals.npz")
    shutil.copy(turn / "parameters.yaml", tmp_path)
    with pytest.raises(SystemExit, match=rf"{name} at 0\.07 s is nan, expected a finite number"):
        main(["replay", str(tmp_path), "--node", "asr", "--out", str(tmp_path / "out")])


def test_instants_that_are_not_those_of_a_control_period_are_refused(turn: Path, tmp_path: Path):
    recording = load(turn / "signals.npz")
    again = Recording(
        recording.time[:300], {name: row[:300] for name, row in recording.channels.items()}
    )
    save(Recording(again.time + 0.003 * (again.time > 1.0), again.channels), tmp_path / "odd.npz")
    with pytest.raises(ParameterError, match="its instants are not those of a control period"):
        find_recorded(tmp_path / "odd.npz")
    with pytest.raises(ParameterError, match="holds 1 whole instants of a run"):
        save(
            Recording(again.time[:1], {name: row[:1] for name, row in again.channels.items()}),
            tmp_path / "one.npz",
        )
        find_recorded(tmp_path / "one.npz")


@pytest.mark.slow
def test_as_recorded_every_role_says_the_same_bits(tmp_path: Path):
    """All roles of a bench, noisy sensors and a bus between, from a bag and signals.npz."""
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
    played = [role for role in ROLES if any(map(bag.has, ROLES[role].writes))]
    assert {"plant", "test_bench", "inverter_gateway"} < set(played)
    for role in played:
        found = differences(bag, tmp_path / "out" / role, role)
        written = {name for signal in ROLES[role].writes for name in TOPICS[signal].channels}
        assert {each.channel for each in found} == written & set(bag.recording.channels)
        assert {each.compared for each in found} == {len(bag.recording.time)}
        assert in_words(found).startswith("bit-identical"), role


def test_every_role_of_a_run_in_speed_mode_can_be_replayed(tmp_path: Path):
    """The plant reads the speeds that the traction control offers beside its torques."""
    words = ["launch_split_mu", "--method", "asr=speed_by_slip", "--offline", "--no-report"]
    main([*words, "--duration", "2", "--run", "steered", "--out", str(tmp_path / "run")])
    recorded = find_recorded(tmp_path / "run" / "signals.npz")
    wanted = "speed_command.speed.front_left"
    assert np.ptp(recorded.recording.channels[wanted]) > 0.0
    for role in ("plant", "steering_column", "driver", "electronic_differential", "asr"):
        found = differences(recorded, tmp_path / "out" / role, role)
        assert in_words(found).startswith("bit-identical"), role
        assert (wanted in {each.channel for each in found}) == (role == "asr")


@pytest.mark.slow
@pytest.mark.weekly
def test_node_of_ones_own_takes_part_in_lockstep(
    turn: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    command = f"{sys.executable} {ROOT / 'docs' / 'examples' / 'own_node.py'}"
    words = [
        str(turn),
        "--node",
        f"asr={command}",
        "--duration",
        "1",
        "--no-report",
        "--out",
        str(tmp_path),
    ]
    run_replay(words)
    assert "bit-identical: 8 channels at 101 instants" in capsys.readouterr().out
