"""Kept runs of a board: it goes on where it was stopped and drives nothing twice."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.schedulers import scheduler_with_two_workers

from ev_core.parameters.data_file import files_in_config
from ev_stack.recording.outcome import RunFailed
from ev_study.benchmark.board import read_board
from ev_study.benchmark.driving import DrivenCell, DrivenLaw, drive_cell
from ev_study.benchmark.kept_cells import KeptCells, kept_cells
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.commands.benchmark import run_benchmark
from ev_study.studies.result_store import ResultStore

SMALL = replace(read_board("small"), draws=2)
STEP = "layout_1_8_c:all:step_steer:wet:*"
LAWS = ["equal_torque", "pi"]
NOTHING = DrivenLaw({}, np.array([]), [], [])


def test_only_what_is_missing_or_would_be_another_number_is_driven():
    store: dict[str, bytes] = {}
    cells = SMALL.cells(STEP)
    kept = kept_cells(SMALL, cells, LAWS, store)
    assert kept.missing() == {cells[0]: LAWS}
    driven = drive_cell(SMALL, cells[0], LAWS)
    kept.keep(driven)
    assert not kept.missing()
    assert repr(kept[0]) == repr(driven)
    assert BoardResult(SMALL, LAWS, kept).hash == BoardResult(SMALL, LAWS, [driven]).hash
    laws = {**SMALL.laws, "pi": {**SMALL.laws["pi"], "allocation": "load"}}
    for board, missing in (
        (replace(SMALL, name="own.yaml", cars=SMALL.cars[1:], scales={}), []),
        (replace(SMALL, laws=laws), ["pi"]),
        (replace(SMALL, seed=2), LAWS),
    ):
        found = kept_cells(board, board.cells(STEP), LAWS, store).missing()
        assert [law for of in found.values() for law in of] == missing


def test_an_edit_of_a_manoeuvre_and_a_choice_of_cells_leave_what_others_have_driven():
    """The first manoeuvre, too, though its run is that in which each law was configured."""
    every = SMALL.cells("layout_1_8_c:all:*:wet:*")
    first = every[0].manoeuvre
    longer = replace(SMALL.manoeuvres[first], duration=SMALL.manoeuvres[first].duration + 1.0)
    edited = replace(SMALL, manoeuvres={**SMALL.manoeuvres, first: longer})
    names, others = (kept_cells(board, every, LAWS, {}).rows.names for board in (SMALL, edited))
    assert [old == new for old, new in zip(names, others, strict=True)] == [
        cell.manoeuvre != first for cell in every for _ in LAWS
    ]
    assert kept_cells(SMALL, every[-1:], LAWS, {}).rows.names == names[-len(LAWS) :]


def test_what_is_broken_is_driven_again(tmp_path: Path):
    store = ResultStore("0" * 24, tmp_path)
    cells = SMALL.cells(STEP)
    kept = kept_cells(SMALL, cells, LAWS, store)
    kept.keep(drive_cell(SMALL, cells[0], LAWS))
    path = store.path(kept.rows.names[0])
    path.write_bytes(path.read_bytes()[:-100])
    assert kept.missing() == {cells[0]: [LAWS[0]]}


def test_what_is_to_be_driven_again_counts_as_missing():
    cells = SMALL.cells(STEP)
    store: dict[str, bytes] = {}
    driven = drive_cell(SMALL, cells[0], LAWS)
    kept_cells(SMALL, cells, LAWS, store).keep(driven)
    kept = kept_cells(SMALL, cells, LAWS, store, anew=True)
    assert kept.missing() == {cells[0]: LAWS}
    kept.keep(driven)
    assert not kept.missing()


def test_what_was_driven_with_a_file_that_has_changed_since_is_not_kept(tmp_path: Path):
    """Each job reads the files again: the numbers may be of another car than the part's name."""
    car = tmp_path / "car.yaml"
    car.write_text(files_in_config("vehicles")["layout_1_8_c"].read_text())
    board = replace(SMALL, cars=[f"{car}:all"])
    (cell,) = cells = board.cells("*:step_steer:wet:*")
    store: dict[str, bytes] = {}
    kept = kept_cells(board, cells, LAWS, store)
    car.write_text(car.read_text().replace("mass: 1600.0", "mass: 1700.0"))
    with pytest.raises(RunFailed, match="has changed since the runs began: start them again"):
        kept.keep(DrivenCell(cell, {"pi": NOTHING}))
    assert not store


WORDS = ["--cells", "layout_1_8_c:all:step_steer:*", "--laws", "pi", "--draws", "4", "--no-report"]


def hash_of(out: Path) -> str:
    return json.loads((out / "board.json").read_text())["hash"]


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> str:
    out = tmp_path_factory.mktemp("whole")
    run_benchmark([*WORDS, "--workers", "1", "--out", str(out)])
    return hash_of(out)


@pytest.mark.weekly
def test_a_board_that_is_killed_goes_on_with_the_same_bits(expected: str, tmp_path: Path, capsys):
    program = "import sys; from ev_stack.commands.run_scenario import main; main(sys.argv[1:])"
    words = [sys.executable, "-c", program, "benchmark", *WORDS, "--out", str(tmp_path)]
    board = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not [*Path(os.environ["EV_STACK_RESULTS"]).glob("*/*.row")]:
        assert board.poll() is None
        time.sleep(0.01)
    board.kill()
    board.wait()
    run_benchmark([*WORDS, "--out", str(tmp_path)])
    assert "of them driven before" in capsys.readouterr().out
    assert hash_of(tmp_path) == expected


@pytest.mark.weekly
def test_a_scheduler_gives_the_same_bits_though_a_worker_is_lost(
    expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """One of two workers is killed with the first result."""
    keep = KeptCells.keep

    def kill(kept, driven) -> None:
        keep(kept, driven)
        victim.kill()

    monkeypatch.setattr(KeptCells, "keep", kill)
    monkeypatch.setattr("ev_study.commands.benchmark.RUNS_OF_A_JOB", 1)
    with scheduler_with_two_workers() as (address, victim):
        run_benchmark([*WORDS, "--scheduler", address, "--out", str(tmp_path)])
        assert victim.wait() != 0
    assert hash_of(tmp_path) == expected
