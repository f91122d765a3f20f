"""Held-out cases.

Other cars, roads and variations by one seed, and boards of which only scores are written.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.refusal import ParameterError
from ev_study.benchmark.board import read_board
from ev_study.benchmark.cell_runs import run_of, values_of
from ev_study.benchmark.draws import drawn
from ev_study.benchmark.held_out import held_out
from ev_study.commands.benchmark import run_benchmark

SMALL = read_board("small")
STEP = "step_steer:wet:*"


def test_a_seed_makes_other_cars_roads_and_draws():
    one, again, other = (held_out(SMALL, seed) for seed in (7, 7, 8))
    assert one == again
    assert not set(one.cars) & set(SMALL.cars)
    assert one.roads != other.roads
    for name, road in one.roads.items():
        assert 0.7 <= road.friction <= 1.1
        assert 0.7 <= road.stiffness <= 1.3
        assert (road.left, road.right) == (SMALL.roads[name].left, SMALL.roads[name].right)
    (cell,) = one.cells(f"audi_a2:front:{STEP}")
    values = values_of(one, cell)
    assert values["plant.road.own_c1"] == [one.roads["wet"].friction * 0.635] * 2
    assert values["plant.road.own_c2"] == [one.roads["wet"].stiffness * 41.915] * 2
    draws = drawn(one, cell, run_of(one, cell, values).configurations)
    assert len(set(draws.values["*.vehicle.centre_of_mass_height"])) == one.draws


def test_every_held_out_cell_has_a_graph():
    board = replace(held_out(SMALL, 1), draws=1)
    # both cars, names and values do not depend on the road
    for cell in board.cells("*:handling:*")[::5]:
        assert drawn(board, cell, run_of(board, cell, values_of(board, cell)).configurations).values


def test_the_command_drives_them_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    words = [
        "--held-out",
        "7",
        "--draws",
        "1",
        "--laws",
        "pi",
        "--cells",
        f"audi_a2:front:{STEP}",
        "--no-report",
    ]
    run_benchmark([*words, "--out", str(tmp_path)])
    assert json.loads((tmp_path / "board.json").read_text())["held_out"] == 7
    assert (
        "benchmark small --draws 1 --held-out 7 --cells 'audi_a2:front:step_steer:wet:*:v3'"
        in capsys.readouterr().out
    )
    with pytest.raises(ParameterError, match="unknown law ''; known: equal_torque"):
        run_benchmark(["--laws", "", "--out", str(tmp_path)])
    with pytest.raises(ParameterError, match="--seed is refused beside --held-out"):
        run_benchmark(["--held-out", "7", "--seed", "1"])
    with pytest.raises(
        ParameterError,
        match="board small has no held_out cases, expected an entry held_out in its file",
    ):
        held_out(replace(SMALL, held_out=None), 1)


def test_of_a_secret_board_nothing_but_scores_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """No road, no cell, no run, no metric.

    The board differs from small in the name of a road and what it records.
    """
    path, out = tmp_path / "secret.yaml", tmp_path / "out"
    text = files_in_config("benchmarks")["small"].read_text()
    path.write_text("recorded: [distance]\n" + re.sub(r"\bwet\b", "puddle", text))
    cells = "layout_1_8_c:all:step_steer:puddle:*"
    words = [
        "--secret",
        str(path),
        "--draws",
        "1",
        "--laws",
        "pi",
        "--cells",
        cells,
        "--no-report",
        "--out",
        str(out),
    ]
    run_benchmark(words)
    written = {each.name for each in out.iterdir()}
    assert written == {"board.json"}
    content = json.loads((out / "board.json").read_text())
    assert len(content["board_sha256"]) == 64
    assert set(content["scores"]) == {"equal_torque", "pi"}
    shown = json.dumps(content | {"command": ""}) + capsys.readouterr().out
    assert "puddle" not in shown
    assert "distance" not in shown
    with pytest.raises(ParameterError, match="is a board, expected no other one beside it"):
        run_benchmark(["small", *words])
