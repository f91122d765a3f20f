"""What a board keeps of its runs: it goes on where it was stopped, whatever stops it, and drives nothing else."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from schedulers import scheduler_with_two_workers

from ev_core.parameters.data_file import files_in_config
from ev_stack.recording.outcome import RunFailed
from ev_study.benchmark import kept_cells
from ev_study.benchmark.board import read_board
from ev_study.benchmark.driving import DrivenCell, drive_cell
from ev_study.benchmark.kept_cells import KeptCells
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.commands.benchmark import run_benchmark

SMALL = replace(read_board("small"), draws=2)
STEP = "layout_1_8_c:all:step_steer:wet:*"
LAWS = ["equal_torque", "pi"]


def test_only_what_is_missing_or_would_be_another_number_is_driven(tmp_path: Path):
    cells = SMALL.cells(STEP)
    kept = KeptCells(SMALL, cells, LAWS, tmp_path)
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
        found = KeptCells(board, board.cells(STEP), LAWS, tmp_path).missing()
        assert [law for of in found.values() for law in of] == missing


def test_an_edit_of_a_manoeuvre_and_a_choice_of_cells_leave_what_others_have_driven():
    """The first manoeuvre, too, though its run is that in which each law was configured."""
    every = SMALL.cells("layout_1_8_c:all:*:wet:*")
    first = every[0].manoeuvre
    longer = replace(SMALL.manoeuvres[first], duration=SMALL.manoeuvres[first].duration + 1.0)
    edited = replace(SMALL, manoeuvres={**SMALL.manoeuvres, first: longer})
    names, others = (KeptCells(board, every, LAWS).files for board in (SMALL, edited))
    assert [old == new for old, new in zip(names, others, strict=True)] == [
        cell.manoeuvre != first for cell in every for _ in LAWS
    ]
    assert KeptCells(SMALL, every[-1:], LAWS).files == names[-len(LAWS) :]


def test_a_file_in_which_any_byte_is_another_one_is_set_aside(tmp_path: Path):
    """Names of arrays, sizes and ways of packing are not all in the checksums of a zip. A lost end counts as well."""
    cells = SMALL.cells(STEP)
    kept = KeptCells(SMALL, cells, LAWS, tmp_path)
    kept.keep(drive_cell(SMALL, cells[0], LAWS))
    path = tmp_path / kept.files[0]
    written, random = path.read_bytes(), np.random.default_rng(1)
    flipped = []
    for place in random.integers(len(written), size=200).tolist():
        flipped.append(bytearray(written))
        flipped[-1][place] ^= int(random.integers(1, 256))
    for content in (*flipped, written[:-100], b""):  # a machine without power leaves an empty one
        path.write_bytes(content)
        with pytest.raises(RunFailed, match="is broken: the same command drives it again"):
            kept[0]
        assert kept.set_broken_aside() == [path]
        assert kept.missing() == {cells[0]: [LAWS[0]]}
        assert (tmp_path / "broken" / path.name).read_bytes() == content
    path.write_bytes(written)
    assert not kept.set_broken_aside() and not kept.missing()


def test_what_was_driven_with_a_file_that_has_changed_since_is_not_kept(tmp_path: Path):
    """Each job reads the files anew, so that the numbers may be of another car than the name of the part."""
    car = tmp_path / "car.yaml"
    car.write_text(files_in_config("vehicles")["layout_1_8_c"].read_text())
    board = replace(SMALL, cars=[f"{car}:all"])
    (cell,) = cells = board.cells("*:step_steer:wet:*")
    kept = KeptCells(board, cells, LAWS, tmp_path)
    car.write_text(car.read_text().replace("mass: 1600.0", "mass: 1700.0"))
    with pytest.raises(RunFailed, match="has changed while the board was driven: start it again"):
        kept.keep(DrivenCell(cell, {"pi": {}}, {}, {}, {}))
    assert not (tmp_path / "driven").exists()


def test_what_other_sources_have_driven_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    """An edit of a source must not cost what took hours; it is driven again beside it."""
    words = ["--cells", STEP, "--laws", "equal_torque", "--draws", "1", "--no-report", "--out", str(tmp_path)]
    run_benchmark(words)
    (before,) = (tmp_path / "driven").iterdir()
    content = before.read_bytes()
    monkeypatch.setattr(kept_cells, "digest_of_sources", lambda config: "f" * 24)
    run_benchmark(words)
    note = f"note: 1 files in {tmp_path / 'driven'} are of other sources: they are neither used nor removed"
    assert note in "".join(capsys.readouterr())
    assert before.read_bytes() == content
    assert len([*(tmp_path / "driven").iterdir()]) == 2


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
    while not [*tmp_path.glob("driven/*.npz")]:
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
