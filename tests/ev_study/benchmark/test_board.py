"""Boards: refusals, cells, equal bits, and single runs by the printed command."""

from __future__ import annotations

import json
import os
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.options import arguments, overrides
from ev_stack.commands.run_scenario import main
from ev_stack.measures.named import driven_run
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.recording.offline import run_offline, true_motion
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.scenario import load_scenario
from ev_study.benchmark.board import read_board
from ev_study.benchmark.cell_runs import run_of, values_of
from ev_study.benchmark.draws import drawn
from ev_study.benchmark.driving import drive_cell
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.tables import closed_division, law_table, score_table
from ev_study.commands.benchmark import run_benchmark

SMALL = replace(read_board("small"), draws=3)
STEP = "layout_1_8_c:all:step_steer:wet:*"
LAWS = ["equal_torque", "pi"]


@pytest.fixture(scope="module")
def result() -> BoardResult:
    return BoardResult(SMALL, LAWS, [drive_cell(SMALL, cell, LAWS) for cell in SMALL.cells(STEP)])


def test_cells_are_cars_by_manoeuvres_by_roads():
    assert len(SMALL.cells()) == 2 * 6 * 3
    assert SMALL.cells(STEP)[0].id("handling") == "layout_1_8_c:all:step_steer:wet:handling:v3"
    with pytest.raises(ParameterError, match="unknown cell 'x:y'"):
        SMALL.cells("x:y")


def test_a_metric_with_the_name_of_a_field_is_refused_before_anything_is_driven(
    result: BoardResult,
):
    """Fields of a run's record, and names that the search of a speed keeps beside metrics."""
    step = SMALL.manoeuvres["step_steer"]
    (cell,) = SMALL.cells(STEP)
    fields = next(iter(result.runs())).keys() - named_metrics(step.measured).keys()
    for name in (*fields, "clean", "runs_driven"):
        named = replace(step, recorded=[f"{name} [rad/s] = largest_magnitude(imu.yaw_rate)"])
        with pytest.raises(
            ParameterError, match=f"metric {name} of step_steer has the name of a field"
        ):
            values_of(replace(SMALL, manoeuvres={"step_steer": named}), cell)


def test_every_cell_has_a_graph_and_every_law_suits_it():
    """The whole board without driving it: names of vehicles, runs, parameters, surfaces."""
    for cell in SMALL.cells("*:handling:*"):
        assert drawn(SMALL, cell, run_of(SMALL, cell, values_of(SMALL, cell)).configurations).values


def test_draws_are_those_of_the_seed_within_their_bounds():
    (cell,) = SMALL.cells(STEP)
    base = run_of(SMALL, cell, values_of(SMALL, cell)).configurations
    one, again, other = (
        drawn(board, cell, base) for board in (SMALL, SMALL, replace(SMALL, seed=2))
    )
    assert one == again != other
    mass = np.array(one.values["*.vehicle.mass"]) / 1600.0
    assert ((mass >= 1.0) & (mass <= 1.2)).all()
    assert len(set(mass)) == SMALL.draws
    friction = np.array(one.values["plant.road.own_c1"]) / 0.635
    assert ((friction >= 0.8) & (friction <= 1.05)).all()
    assert all(0.7 <= factor <= 1.3 for factor in one.believed)


def test_the_reference_costs_one_and_the_control_lowers_the_energy_of_a_step(result: BoardResult):
    """Understeer as designed takes less side force than the step of the car without control."""
    assert (result.costs["handling"][0] == 1.0).all()
    assert result.scores["energy"][1].value < 0.99
    assert not result.unstable.any()
    assert [row[0] for row in score_table(result, LAWS).rows] == ["equal_torque", "pi"]
    assert closed_division(result) == []
    ((law, handling, energy, step, wins, breaks),) = law_table(result).rows
    assert (law, step, wins) == ("pi", "-", "nowhere")
    assert (handling.split()[0], energy.split()[0]) == ("0", "100")
    assert breaks.startswith("layout_1_8_c:all:step_steer:wet: ")


def test_twice_gives_equal_bits_with_other_laws_and_threads(result: BoardResult):
    """Draws belong to the cell and not to the laws."""
    again = drive_cell(SMALL, SMALL.cells(STEP)[0], ["pi"], threads=1)
    for name, values in result.cells[0].metrics["pi"].items():
        assert values.tolist() == again.metrics["pi"][name].tolist()


def test_the_command_of_a_run_drives_it_again(result: BoardResult):
    """Words of a shell give all metrics to the bit.

    The second draw of a law with an own parameter drawn stands for all.
    """
    words = shlex.split(result.cells[0].laws["pi"].commands[1])
    assert words[0] == "scripts/run.sh"
    given = arguments([*words[1:], "--offline"])
    run = load_scenario(given.scenario, overrides(given), given.run).runs[0]
    assert (run.name, len(given.run)) == ("left", 1)
    motion = true_motion(run_offline(run.configurations, run.duration), run.configurations)
    for name, metric in named_metrics(SMALL.manoeuvres["step_steer"].measured).items():
        assert (
            metric.measured(driven_run(motion, run.configurations)).value
            == result.cells[0].metrics["pi"][name][1]
        )


def test_the_command_writes_scores_and_all_runs(tmp_path: Path, capsys):
    words = ["benchmark", "--cells", STEP, "--laws", "pi", "--draws", "1"]
    main([*words, "--out", str(tmp_path)])
    board, runs = (
        json.loads((tmp_path / f"{name}.json").read_text()) for name in ("board", "runs")
    )
    assert [each["law"] for each in runs["runs"]] == LAWS
    assert len(board["profiles"]["pi"]["energy"]["low"]) == len(board["profiles"]["cost"])
    assert board["probability_of_improvement"]["pi"]["equal_torque"]["energy"]["value"] == 1.0
    assert 0 < board["step_time_ns"]["equal_torque"] < board["step_time_ns"]["pi"]  # a tenth
    assert (tmp_path / "board.png").stat().st_size > 10_000
    assert set(board["scores"]["pi"]) == {
        "handling",
        "worst tenth",
        "energy",
        "unstable",
        "demand_met",
    }
    printed = capsys.readouterr().out
    assert f"hash of all runs {board['hash']}" in printed
    assert (
        f"scripts/run.sh benchmark small --draws 1 --cells '{STEP}:v3' --drive equal_torque:0"
        in printed
    )
    assert "driven before" not in printed
    part = next(Path(os.environ["EV_STACK_RESULTS"]).glob("*/*.row"))
    part.write_bytes(part.read_bytes()[::-1])
    main([*words, "--no-report", "--out", str(tmp_path / "again")])
    printed, errors = capsys.readouterr()
    assert f"hash of all runs {board['hash']}" in printed
    assert ", 1 of them driven before" in printed
    assert f"{part} does not fit its checksum: it is removed and made again" in errors


@pytest.mark.parametrize("way", ["--offline", "--in-process"])
def test_the_command_beside_a_cell_gives_the_hash_of_the_board(
    result: BoardResult, way: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Whatever drives the run.

    The batch of the board, the offline runner, nodes in one process over DDS.
    """
    (expected,) = [
        run["signal_hash"] for run in result.runs() if (run["law"], run["draw"]) == ("pi", 1)
    ]
    words = shlex.split(
        replace(result, words=["benchmark", "small", "--draws", "3"]).once_more(0, 1, 1)
    )
    assert words[:2] == ["scripts/run.sh", "benchmark"]
    main([*words[1:], way, "--no-report", "--out", str(tmp_path)])
    assert f"signal hash {expected}\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ["--drive", "pi:10"],
            "--drive 'pi:10' is refused, expected LAW:DRAW with a draw from 0 to 9",
        ),
        (["--drive", "none:1"], "unknown law 'none'"),
        (["--drive", "pi:1"], "--drive is for one cell, 36 fit '*'; expected --cells ID"),
        (
            ["--offline"],
            "--offline and --in-process are refused: a board is driven in batches, expected with --drive",
        ),
    ],
)
def test_what_cannot_be_driven_alone_is_one_line(words: list[str], line: str):
    with pytest.raises(ParameterError) as refused:
        run_benchmark(words)
    assert str(refused.value).startswith(line)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("draws: 10", "draws: 0", "draws is 0, expected 1 to 100000"),
        ("draws: 10", "draws: many", "draws of a board is 'many', expected a whole number"),
        ("seed: 1", "sed: 1", "unknown entry of a board 'sed'"),
        ("reference: equal_torque", "reference: none", "unknown reference 'none'"),
        ("roads: [dry, wet, snow]", "roads: [mud]", "unknown road of step_steer 'mud'"),
        (
            "energy: [battery_energy]",
            "energy: [distance]",
            "metric distance of step_steer is better neither",
        ),
        (
            "dry: {left: [dry_asphalt],",
            "dry: {left: [dry_asphalt, ice],",
            "road dry needs as many surfaces left as right, and a length for all but the last",
        ),
        ("wet: {left: [wet_asphalt_2]", "wet: {left: [mud]", "unknown surface of wet 'mud'"),
        (
            "handling: [yaw_rate_error,",
            "handling: [1,",
            "handling of manoeuvre step_steer is [1, 'peak_sideslip'], expected a list, each element a text",
        ),
        (
            "unstable: 0.5 ",
            "unstable: .nan ",
            "unstable of a board is nan, expected a finite number",
        ),
        ("seed: 1", "seed: -1", "seed is -1, unstable 0.5, expected 0 or more, above 0 to 1.57"),
        (
            "unstable: 0.5 ",
            "unstable: 1.6 ",
            "seed is 1, unstable 1.6, expected 0 or more, above 0 to 1.57",
        ),
        (
            "peak_slip: 0.02",
            "peak_slip: .inf",
            "scales lacks a number above 0 for peak_slip of launch",
        ),
        (
            "peak_slip: 0.02",
            "peak_slip: 0",
            "scales lacks a number above 0 for peak_slip of launch",
        ),
        (
            "factor: [1.0, 1.2]",
            "factor: [1.2, 1.0]",
            "variation of *.vehicle.mass has the bounds [1.2, 1.0]",
        ),
        ("{method: load_proportional}", "{}", "law load_proportional lacks method"),
        ("  pi: [pi.*]", "  pi: pi.*", "tuned has pi with 'pi.*', expected a list of texts"),
        (
            "{method: load_proportional}",
            "{method: open, asr.backstop: 1}",
            "law load_proportional lacks asr.method",
        ),
        (
            "closed: [pi,",
            "closed: [pi_neutral,",
            "closed has laws that differ in one of method, reference,",
        ),
    ],
)
def test_what_is_wrong_in_a_board_is_one_line(tmp_path: Path, old: str, new: str, line: str):
    text = files_in_config("benchmarks")["small"].read_text()
    assert old in text
    path = tmp_path / "own.yaml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ParameterError) as refused:
        read_board(str(path))
    assert line in str(refused.value)
    assert str(refused.value).startswith(f"{path}: ")
    assert "\n" not in str(refused.value)


def test_a_car_without_steering_angles_of_its_own_is_no_cell():
    """Angles of another car would be another test for this one than for the others."""
    step = SMALL.manoeuvres["step_steer"]
    at_rest = replace(step, values={"plant.initial_speed": 0.0})
    board = replace(SMALL, manoeuvres={**SMALL.manoeuvres, "step_steer": at_rest})
    cell = next(cell for cell in board.cells() if cell.manoeuvre == "step_steer")
    with pytest.raises(ParameterError, match="a slow ramp gives none: the run begins at rest"):
        run_of(board, cell, values_of(board, cell))


def test_a_law_in_speed_mode_drives_a_cell_as_the_run_alone():
    """Its traction control requires an option of the plant, which a scenario sets as well."""
    law = {"method": "equal_torque", "asr.method": "speed_by_slip"}
    board = replace(SMALL, draws=1, laws={**SMALL.laws, "fast": law})
    cell = SMALL.cells(STEP)[0]
    driven = drive_cell(board, cell, ["fast"], threads=1).laws["fast"]
    words = shlex.split(driven.commands[0])
    given = arguments([*words[1:], "--offline"])
    run = load_scenario(given.scenario, overrides(given), given.run).runs[0]
    assert run.configurations["plant"].parameters.speed_mode
    alone = run_offline(run.configurations, run.duration)
    assert driven.hashes == [signal_hash(alone)]
