"""Sweeps: values times values times seeds, each run as it is alone, and their files."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
from pathlib import Path

import pytest

import ev_stack
from ev_core.parameters.data_file import find_file
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import load, signal_hash
from ev_stack.report.tables import write_tables
from ev_study.studies import run_study, sweep
from ev_study.studies.run_study import arguments, study_cases
from ev_study.studies.study import drive_case

WORDS = (
    "shchur2019",
    "--vary",
    "electronic_differential.gamma=0:10:3",
    "--vary",
    "plant.initial_speed=2.0,4.0",
)


def sweep_into(out: Path, *more: str) -> Path:
    words = ["--seeds", "2", "--duration", "0.1", "--workers", "1", "--out", str(out), *more]
    main(["sweep", *WORDS, *words])
    return out


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return sweep_into(tmp_path_factory.mktemp("sweep"))


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "table.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(("text", "values"), [("1:3:3", [1, 2, 3]), ("0:1:3", [0.0, 0.5, 1.0])])
def test_whole_numbers_from_first_to_last_are_whole(text, values):
    """`--vary plant.road.seed=1:3:3` is three roads."""
    given = arguments("sweep", ["urban_mixed", "--vary", f"plant.road.seed={text}"])
    assert repr(sweep.variations(given)["plant.road.seed"]) == repr(values)


@pytest.mark.slow
def test_each_row_is_the_run_alone(folder):
    found = rows(folder)
    assert len(found) == 3 * 2 * 2
    row = found[-1]
    assert (row["electronic_differential.gamma"], row["plant.initial_speed"], row["seed"]) == (
        "10",
        "4.0",
        "1",
    )
    changed = {"electronic_differential.gamma": 10.0, "plant.initial_speed": 4.0}
    alone = ev_stack.run("shchur2019", set=changed, seed=1, duration=0.1)
    measured = {name: metric for name, metric in alone.metrics.items() if metric.value is not None}
    assert measured
    for name, metric in measured.items():
        assert float(row[f"{name} [{metric.unit}]"]) == metric.value


@pytest.mark.slow
def test_what_a_sweep_leaves_behind(folder):
    assert {path.name for path in folder.iterdir()} >= {
        "summary.json",
        "sweep.png",
        "table.md",
        "table.tex",
    }
    summary = json.loads((folder / "summary.json").read_text())
    assert len(summary["cases"]) == 12
    assert "electronic_differential.gamma=0, plant.initial_speed=2, seed=0" in summary["cases"]
    assert (folder / "table.md").read_text().count("\n") == 2 + 12


@pytest.mark.slow
def test_a_sweep_that_was_killed_goes_on_where_it_was(tmp_path, capsys):
    """Killed when five rows were kept, and a sixth was half written."""
    results = Path(os.environ["EV_STACK_RESULTS"])
    first, second = tmp_path / "first", tmp_path / "second"
    sweep_into(first)
    rows = sorted(results.glob("*/*.row"))
    for row in rows[6:]:
        row.unlink()
    rows[5].write_bytes(rows[5].read_bytes()[:100])
    capsys.readouterr()
    sweep_into(second)
    output = capsys.readouterr().out
    assert "12 runs, 1.2 s in" in output
    assert "5 of them driven before" in output
    assert (second / "table.csv").read_bytes() == (first / "table.csv").read_bytes()


@pytest.mark.slow
def test_signals_are_kept_where_they_are_asked_for(folder, tmp_path):
    hashes = {
        name: case["signal_hash"]
        for name, case in json.loads((folder / "summary.json").read_text())["cases"].items()
    }
    out = sweep_into(tmp_path, "--signals")
    cases = json.loads((out / "summary.json").read_text())["cases"]
    found = {name: signal_hash(load(out / case["signals"])) for name, case in cases.items()}
    assert found == hashes


@pytest.mark.weekly
@pytest.mark.slow
def test_signals_stay_while_another_command_drives_the_same(tmp_path, monkeypatch):
    """It begins when the first one has driven, and is stopped at once.

    Both keep signals in one place.
    """
    drive = run_study.drive_cases

    def stopped(*given):
        raise RunFailed("stopped")

    def drive_while_another_begins(*given):
        driven = drive(*given)
        monkeypatch.setattr(run_study, "drive_cases", stopped)
        with pytest.raises(SystemExit, match="stopped"):
            sweep_into(tmp_path / "other", "--signals", "--anew")
        return driven

    monkeypatch.setattr(run_study, "drive_cases", drive_while_another_begins)
    sweep_into(tmp_path / "first", "--signals")
    for case in json.loads((tmp_path / "first" / "summary.json").read_text())["cases"].values():
        assert signal_hash(load(tmp_path / "first" / case["signals"])) == case["signal_hash"]


@pytest.mark.slow
def test_rows_and_signals_are_those_of_the_car_as_its_file_is_now(tmp_path, capsys):
    """A file changed from 1600 to 3000 kg, named by the user's scenario, is driven again."""
    car, own = (
        find_file(f"{name}.yaml").read_text()
        for name in ("vehicles/compact_ev", "scenarios/coast_down")
    )
    (tmp_path / "own.yaml").write_text(
        own.replace("vehicle: audi_a2", f"vehicle: {tmp_path / 'car.yaml'}")
    )
    words = [
        "--vary",
        "plant.initial_speed=20.0,25.0",
        "--duration",
        "0.1",
        "--workers",
        "1",
        "--no-report",
    ]
    found = []
    for mass in ("1600.0", "3000.0"):
        (tmp_path / "car.yaml").write_text(car.replace("mass: 1600.0", f"mass: {mass}"))
        out = tmp_path / mass
        main(["sweep", str(tmp_path / "own.yaml"), *words, "--signals", "--out", str(out)])
        cases = json.loads((out / "summary.json").read_text())["cases"].values()
        found += [each["signal_hash"] for each in cases]
        assert [signal_hash(load(out / each["signals"])) for each in cases] == found[-2:]
    assert len(set(found)) == 4
    assert "driven before" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--vary", "gamma=1"],
            "--vary 'gamma=1' is refused, expected NODE.PARAM=x,y,z or =FIRST:LAST:COUNT",
        ),
        *(
            (["--vary", f"asr.x={text}"], f"--vary 'asr.x={text}' is refused, expected {allowed}")
            for text, allowed in (
                ("a:b:3", "FIRST:LAST:COUNT of numbers, such as 0:10:11 for 11 of them"),
                ("0:10", "FIRST:LAST:COUNT of numbers, such as 0:10:11 for 11 of them"),
                ("0:10:2.5", "FIRST:LAST:COUNT of numbers, such as 0:10:11 for 11 of them"),
                ("0:10:1000000000", "a COUNT from 2 to 100000 in FIRST:LAST:COUNT"),
                ("0:10:0", "a COUNT from 2 to 100000 in FIRST:LAST:COUNT"),
                ("0:10:1", "a COUNT from 2 to 100000 in FIRST:LAST:COUNT"),
                ("0:1e999:3", "FIRST:LAST:COUNT of finite numbers"),
            )
        ),
        (["--seeds", "0"], "--seeds 0 is refused, expected 1 to 100000"),
        (["--seeds", "1000000000000"], "--seeds 1000000000000 is refused, expected 1 to 100000"),
        (
            ["--seeds", "1000", "--vary", "asr.x=0:1:1000"],
            "a sweep of 1000000 runs is refused, expected at most 100000; docs/batch.md has what drives more",
        ),
        ([], "a sweep of nothing is refused, expected --vary NODE.PARAM=x,y,z, --seeds N, or both"),
    ],
)
def test_words_without_sense_are_one_line(words, message):
    """`0:10:1000000000` and `0:10:0` are refused before they take memory or drive."""
    with pytest.raises(ParameterError) as error:
        sweep.cases(arguments("sweep", ["shchur2019", *words]))
    assert str(error.value) == message


@pytest.mark.parametrize("order", ["true,false", "false,true"])
def test_a_value_for_an_option_that_one_case_has_is_taken(order):
    """As with methods: it is enough that some case uses it, in any order of the cases."""
    words = ["--vary", f"plant.electrical={order}", "--set", "plant.sensors.motor_current.bias=1"]
    given = arguments("sweep", ["double_lane_change", *words])
    assert len(study_cases(sweep, given)) == 2


def test_what_varies_is_a_parameter_of_a_node():
    """A duration is the scenario's own, for --duration: no method plays it."""
    words = ["sweep", "double_lane_change", "--vary", "scenario.duration=1,2"]
    with pytest.raises(SystemExit, match=r"^error: unknown node 'scenario'"):
        main(words)


def test_runs_too_short_for_any_metric_have_a_line():
    """The line has the reason: a coast-down takes 10 s to be one."""
    given = arguments("sweep", ["coast_down", "--vary", "plant.initial_speed=15.00001,15.00002"])
    short = [dataclasses.replace(case, duration=0.1) for case in sweep.cases(given)]
    table = sweep.tables(given, {case.name: drive_case(case, sweep.measure) for case in short})
    assert table.splitlines()[2:] == [
        "           15.00001",
        "           15.00002",
        "",
        "no metric was measured: scripts/run.sh coast_down says why",
    ]


def test_metrics_are_named_before_anything_is_driven():
    """`--metrics yaw_rate_error` drove 15 runs, and then was unknown."""

    def cases(scenario: str, metrics: str) -> list:
        return sweep.cases(arguments("sweep", [scenario, "--seeds", "2", "--metrics", metrics]))

    asked = cases("step_steer", "yaw_rate_gain,slip_energy,x [1] = maximum(hypot(pose.x, pose.y))")
    assert {case.metrics for case in asked} == {
        ("slip_energy", "x [1] = maximum(hypot(pose.x, pose.y))")
    }
    for scenario, metrics, message in (
        (
            "step_steer",
            "yaw_rate_eror",
            "unknown metric 'yaw_rate_eror'; did you mean yaw_rate_error, ",
        ),
        (
            "shchur2019",
            "peak_slip",
            "metric peak_slip needs tire_forces.slip_ratio, which none of these writes: plant ",
        ),
        (
            "step_steer",
            "x [1] = maxi(pose.x)",
            "metric 'x [1] = maxi(pose.x)' is refused: unknown function 'maxi'; ",
        ),
    ):
        with pytest.raises(ParameterError) as error:
            cases(scenario, metrics)
        assert str(error.value).startswith(message)


def test_values_that_are_rounded_inside_are_noted(tmp_path, capsys):
    """`preview_time` is rounded to 0.05 s: 1.00 and 1.01 s are one, 1.10 s is another."""
    words = [
        "--vary",
        "driver.preview.preview_time=1.0,1.01,1.1",
        "--duration",
        "0.5",
        "--workers",
        "1",
        "--no-report",
    ]
    main(["sweep", "double_lane_change", *words, "--out", str(tmp_path)])
    assert "note: 2 different runs among 3: the others have" in capsys.readouterr().out


RESERVED = (
    "metrics",
    "units",
    "reasons",
    "better",
    "time",
    "speed",
    "x",
    "method",
    "seed",
    "value",
)


@pytest.mark.sampled
@pytest.mark.parametrize("study", ["sweep", "compare"])
@pytest.mark.parametrize("name", RESERVED)
def test_a_metric_of_any_name_is_measured(study, name, tmp_path, capsys):
    """A name of a user's overwrites nothing that a study keeps of a run under the same name."""
    words = {
        "sweep": ["step_steer", "--seeds", "2"],
        "compare": ["--scenario", "step_steer", "--methods", "equal_torque"],
    }
    metric = f"{name} [m/s] = last(twist.longitudinal)"
    main(
        [
            study,
            *words[study],
            "--duration",
            "0.1",
            "--metrics",
            metric,
            "--out",
            str(tmp_path),
            "--workers",
            "1",
        ]
    )
    cases = json.loads((tmp_path / "summary.json").read_text())["cases"]
    assert {round(case["measured"][name]) for case in cases.values()} == {22}  # of 80 km/h
    assert f"{name} [m/s]" in capsys.readouterr().out


def test_the_terminal_shows_each_number_once_and_how_long_it_takes(tmp_path, capsys):
    words = [
        "--seeds",
        "2",
        "--duration",
        "0.1",
        "--workers",
        "1",
        "--no-report",
        "--out",
        str(tmp_path / "out"),
    ]
    main(
        [
            "sweep",
            "shchur2019",
            *words,
            "--metrics",
            "drive_energy,peak_slip_of_none [1] = last(time)",
        ]
    )
    captured = capsys.readouterr()
    assert captured.err.startswith("sweep: 2 runs\nsweep: 2 of them to drive, in about 0:00:0")
    assert "measured" not in captured.out
    assert captured.out.count("drive_energy") == 1


def test_values_are_numbers_texts_and_units():
    given = arguments(
        "sweep",
        ["--vary", "plant.drive=ideal,averaged", "--vary", "plant.initial_speed=10 km/h,5.0"],
    )
    assert sweep.variations(given) == {
        "plant.drive": ["ideal", "averaged"],
        "plant.initial_speed": ["10 km/h", 5.0],
    }
    assert [case.name for case in sweep.cases(given)][:2] == [
        "plant.drive=ideal, plant.initial_speed=10 km/h",
        "plant.drive=ideal, plant.initial_speed=5",
    ]


def test_parquet_keeps_all_digits_gaps_and_texts(tmp_path):
    """It is an extra: pyarrow has 50 MB, which nothing else needs."""
    parquet = pytest.importorskip("pyarrow.parquet")
    rows = [[1 / 3, "a_b", "10 km/h", 1], [None, "c|d", 5.0, 2]]
    write_tables(tmp_path, ["peak_slip [%]", "name", "plant.initial_speed", "seed"], rows)
    found = parquet.read_table(tmp_path / "table.parquet").to_pydict()
    assert found == {
        "peak_slip [%]": [1 / 3, None],
        "name": ["a_b", "c|d"],
        "plant.initial_speed": ["10 km/h", "5.0"],
        "seed": [1, 2],
    }


def test_tables_keep_all_digits_for_machines_and_mask_what_latex_knows(tmp_path):
    write_tables(tmp_path, ["peak_slip [%]", "name"], [[1 / 3, "a_b"], [None, "c|d"]])
    assert (
        tmp_path / "table.csv"
    ).read_text() == "peak_slip [%],name\n0.3333333333333333,a_b\n,c|d\n"
    assert r"{peak\_slip [\%]} & {name} \\" in (tmp_path / "table.tex").read_text()
    assert r"0.3333 & a\_b \\" in (tmp_path / "table.tex").read_text()
    assert (tmp_path / "table.md").read_text().endswith("| - | c&#124;d |\n")


def test_steering_angles_of_another_car_are_noted(tmp_path, capsys):
    """No ramp gives angles at rest; two other speeds have angles of their own, in one line."""
    words = ["--vary", "plant.initial_speed=0,10,12", "--duration", "0.1", "--workers", "1"]
    out = ["--no-report", "--out", str(tmp_path)]
    main(["sweep", "step_steer", *words, *out])
    notes = [line for line in capsys.readouterr().out.splitlines() if line.startswith("note: ")]
    angles = "left: steering angles are those of the scenario's own car, a slow ramp gives none"
    assert sum(f"plant.initial_speed=0: {angles}" in line for line in notes) == 1
    own = "note: plant.initial_speed=10 and 1 more: left: steering_column.scale is"
    assert sum(line.startswith(own) for line in notes) == 1
