"""scripts/run.sh validate: a car against its own record, and against that of another one."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from measured.made_records import CAR, PERIOD, columns_of, driven, write

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides
from ev_study.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    measured,
)
from ev_study.measured.records.samples import Sampled
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_study.measured.replays.validation import Validation

IN_CORRIDORS = ("steering_angle", "twist.yaw_rate", "sideslip")


def test_the_car_that_made_the_record_is_found_right_and_a_softer_one_wrong(tmp_path, capsys):
    """Errors of the very car are those of a window's start: wheels and loads in the manoeuvre.

    That is below 1 % of the signals. Another car is ten times as far off at least.
    """
    record = str(write(tmp_path, columns_of(driven())))
    of = ["validate", record, "--window", "2"]
    main([*of, "--vehicle", CAR, "--out", str(tmp_path / "right")])
    page = (tmp_path / "right" / "report.html").read_text()
    assert page.count("data:image/png") == 3
    assert "compact_ev against made.csv" in page
    out = capsys.readouterr().out
    assert "twist.yaw_rate" in out
    assert "6 windows of 2 s" in out
    found = json.loads((tmp_path / "right" / "summary.json").read_text())
    assert found["errors"]["twist.yaw_rate"]["explained"] > 0.9999
    assert found["errors"]["sideslip"]["explained"] > 0.999
    assert found["metrics"]["windows_left"]["value"] == 0.0
    assert {name: each["share"] for name, each in found["corridors"].items()} == dict.fromkeys(
        IN_CORRIDORS, 1.0
    )
    main([*of, "--no-report", "--vehicle", "audi_a2", "--out", str(tmp_path / "wrong")])
    wrong = json.loads((tmp_path / "wrong" / "summary.json").read_text())
    assert wrong["corridors"]["twist.yaw_rate"]["share"] < 1.0
    assert (
        wrong["errors"]["twist.yaw_rate"]["rms"] > 10.0 * found["errors"]["twist.yaw_rate"]["rms"]
    )


def test_a_record_without_what_is_imposed_is_refused(tmp_path, capsys):
    path = write(tmp_path, columns_of(driven()))
    mapping = tmp_path / "made.yaml"
    mapping.write_text(
        "\n".join(
            line for line in mapping.read_text().splitlines() if "steering_column" not in line
        )
    )
    with pytest.raises(SystemExit) as ended:
        main(["validate", str(path), "--vehicle", CAR, "--out", str(tmp_path / "out")])
    assert "steering_column.state.angle" in str(ended.value)


@pytest.mark.parametrize("lacking", ["twist.longitudinal", "twist.yaw_rate"])
def test_a_record_without_speed_or_yaw_rate_is_refused(tmp_path, lacking):
    path = write(tmp_path, columns_of(driven()))
    mapping = tmp_path / "made.yaml"
    lines = mapping.read_text().replace(", x: 1.0, y: 0.5", "").splitlines()
    mapping.write_text("\n".join(line for line in lines if lacking not in line))
    with pytest.raises(SystemExit, match=f"unknown channel of .*made.csv '{lacking}'"):
        main(["validate", str(path), "--vehicle", CAR, "--out", str(tmp_path / "out")])


OF_THE_RECORD = [
    ("speed", "plant.speed=free"),
    ("speed", "*.initial_hold=0.0"),
    ("pedals", "plant.initial_speed=3.0"),
    ("speed", "plant.imposed_speed.speed=[1.0]"),
    ("speed", "steering_column.angle=[0.0]"),
    ("speed", "driver.pedals.begin=false"),
    ("torques", "electronic_differential.drive.front_left=[10.0]"),
]


@pytest.mark.parametrize(
    ("imposed", "value"), OF_THE_RECORD, ids=[value for _, value in OF_THE_RECORD]
)
def test_a_value_that_a_replay_has_from_the_record_is_refused(tmp_path, imposed, value):
    """It would have no effect, or none that anybody could want."""
    path, name = write(tmp_path, columns_of(driven())), value.partition("=")[0]
    with pytest.raises(
        SystemExit, match=f"error: {re.escape(name)} is refused: a replay has it from the record"
    ):
        main(["validate", str(path), "--vehicle", CAR, "--impose", imposed, "--set", value])
    with pytest.raises(
        SystemExit, match=r"plant\.initial_speed is refused: a replay has it from the record"
    ):
        main(["identify", str(path), "--vehicle", CAR, "--window", "2", "--free", "plant.initial_speed",
              "--out", str(tmp_path / "out")])  # fmt: skip


def test_numbers_of_a_tyre_beside_its_file_are_refused_in_a_replay():
    """The file has them: the replay would be that of the file, whatever is set."""
    tyre = graph("compact_ev", PERIOD)["plant"].common.vehicle.tyre
    values = [("*", "vehicle.tyre.rear_mf", [2.0 * each for each in tyre.rear_mf])]
    message = "^plant: parameter vehicle.tyre.rear_mf is refused: vehicle.tyre.rear_file"
    with pytest.raises(ParameterError, match=message):
        graph("compact_ev", PERIOD, Overrides(values=values))


@pytest.mark.parametrize("gap", [(8.0, 8.0), (4.0, 4.6), (4.0, 6.0)])
def test_an_unmeasured_lateral_velocity_is_there_when_a_window_begins(gap):
    """The second before a window is driven as measured, also at a record's begin and behind a gap.

    The very car follows to 0.0002 rad/s then; windows that began at once would be up to 0.008 rad/s
    off.
    """
    run = driven()
    kept = ~((run.time > gap[0]) & (run.time < gap[1]))
    columns = {
        name: (Sampled(run.time[kept], run.channels[name][kept]), ColumnParameters())
        for name in (LONGITUDINAL, YAW_RATE, ROAD_WHEEL_ANGLE)
    }
    record = measured("made", "", columns, MaskParameters())
    replay = OpenLoop(record, windows_of(record, 2.0), graph(CAR, PERIOD))
    off = replay.simulate()[YAW_RATE][0] - replay.measured(YAW_RATE)
    assert np.sqrt(np.mean(off**2, axis=1)).max() < 2e-4
    first = [1.0, 3.0, 5.0, 7.0, 9.0] if gap[0] == gap[1] else [1.0, gap[1] + 1.0]
    assert record.time[replay.windows.first][: len(first)] == pytest.approx(first)


def test_a_replay_has_the_period_of_the_record(tmp_path):
    """Another one of --set or of a file would put its instants beside those that were measured."""
    path, other = write(tmp_path, columns_of(driven())), tmp_path / "other.yaml"
    other.write_text("/**:\n  ros__parameters:\n    control_period: 0.002\n")
    for given, period in (
        (["--set", "*.control_period=0.02"], "0.02"),
        (["--params", str(other)], "0.002"),
    ):
        with pytest.raises(
            SystemExit, match=f"control_period is {period} s, expected that of the record, 0.01 s"
        ):
            main(["validate", str(path), "--vehicle", CAR, *given])


def test_the_torque_of_each_wheel_is_imposed_by_itself(tmp_path, capsys):
    """A car turned by a difference of front torques alone, and a brake at one rear wheel.

    Replayed with its torques it is where it was; with those of left and right exchanged it turns
    the other way. What has no column is zero and named; a drive torque at a wheel without a motor
    is refused.
    """
    time = np.arange(602) * PERIOD
    torques = {
        "drive.front_left": 60.0 - 40.0 * np.sin(2.0 * time),
        "drive.front_right": 60.0 + 40.0 * np.sin(2.0 * time),
        "brake.rear_left": 30.0 * (1.0 + np.sin(time)),
    }
    values = [
        ("plant", "initial_speed", 20.0),
        ("plant", "speed", "free"),
        ("plant", "initial_hold", 0.0),
    ]
    values += [("electronic_differential", "time", time.tolist())]
    values += [
        ("electronic_differential", f"{kind}.{wheel}", [0.0] * 602)
        for kind in ("drive", "brake")
        for wheel in WHEEL_NAMES
    ]
    values += [
        ("electronic_differential", name, torque.tolist()) for name, torque in torques.items()
    ]
    made = run_offline(graph(CAR, PERIOD, Overrides(values=values), "torques"), 6.0)
    measured = columns_of(made) | {
        name: made.channels[f"torque_command.{name}"] for name in torques
    }
    record = write(tmp_path, measured)
    mapping = record.with_suffix(".yaml")
    own = mapping.read_text()

    def validated(names: dict[str, str], out: str) -> dict[str, dict[str, float]]:
        lines = [
            f"  torque_command.{name}: {{column: {column}, unit: N m}}\n"
            for name, column in names.items()
        ]
        mapping.write_text(own + "".join(lines))
        main(
            [
                "validate",
                str(record),
                "--window",
                "2",
                "--impose",
                "torques",
                "--vehicle",
                CAR,
                "--no-report",
                "--out",
                str(tmp_path / out),
            ]
        )
        return json.loads((tmp_path / out / "summary.json").read_text())["errors"]

    right = validated({name: name for name in torques}, "right")
    assert right["twist.yaw_rate"]["explained"] > 0.999
    assert right["twist.longitudinal"]["rms"] < 0.01
    out = capsys.readouterr().out
    assert "taken as zero: torque_command.drive.rear_left" in out
    (left,) = re.findall(r"do not follow.*front_left ([\d.]+) N m", out)
    # N m: the gear keeps 3 % of what it is asked for
    assert float(left) == pytest.approx(0.03 * 62.0, rel=0.3)
    exchanged = validated(
        {
            name: name.replace("left", "x").replace("right", "left").replace("x", "right")
            for name in list(torques)[:2]
        },
        "exchanged",
    )
    assert exchanged["twist.yaw_rate"]["explained"] < 0.0
    with pytest.raises(SystemExit, match=r"drive\.rear_left: a torque there is refused"):
        validated({"drive.rear_left": "drive.front_left"}, "refused")


def test_what_is_written_has_every_instant_of_every_window_once():
    """The end of a window in front of a gap is in no other one, that in front of a window in both."""
    run = driven(6.0)
    kept = ~((run.time > 2.5) & (run.time < 3.5))
    columns = {
        name: (Sampled(run.time[kept], run.channels[name][kept]), ColumnParameters())
        for name in (LONGITUDINAL, LATERAL, YAW_RATE, ROAD_WHEEL_ANGLE)
    }
    record = measured("made", "", columns, MaskParameters())
    replay = OpenLoop(record, windows_of(record, 1.0), graph(CAR, PERIOD))
    simulated = {YAW_RATE: np.zeros((len(replay.windows), replay.windows.size))}
    both = Validation(replay, simulated, 0.0).recordings()
    # Windows from 0, 1, 3.5 and 4.5 s on, each with both of its ends.
    wanted = np.unique(replay.windows.of(record.time))
    assert len(replay.windows) == 4
    assert np.count_nonzero(np.diff(wanted) > 1.5 * record.period) == 1
    assert np.array_equal(both["measured"].time, wanted)
    assert np.array_equal(both["simulated"].time, wanted)
    assert len(both["measured"].channels[YAW_RATE]) == len(wanted)
