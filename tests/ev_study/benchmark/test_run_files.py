"""The files with a record of each run.

Alike in JSON, in lines and in Parquet, with two cells in memory at most.
"""

from __future__ import annotations

import gzip
import json
import weakref
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ev_stack.measures.own_metrics import named_metrics
from ev_study.benchmark.board import Cell, read_board
from ev_study.benchmark.driving import DrivenCell, DrivenLaw
from ev_study.benchmark.ranking import run_files
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.tables import cell_table

BOARD = replace(read_board("small"), draws=4)
LAWS = [BOARD.reference, "pi"]


class Invented(Sequence[DrivenCell]):
    """Cells without a run, made on request, and the most of them that were held at once."""

    def __init__(self, cells: Sequence[Cell]) -> None:
        self._cells, self._made = cells, list[weakref.ref[DrivenCell]]()
        self.most = 0

    def __len__(self) -> int:
        return len(self._cells)

    def __getitem__(self, number: int) -> DrivenCell:
        cell, draws = self._cells[number], BOARD.draws
        numbers = np.random.default_rng(number).random((len(LAWS), draws))
        numbers[:, 0] = np.nan
        names = named_metrics(BOARD.manoeuvres[cell.manoeuvre].measured)
        laws = {}
        for law, of in zip(LAWS, numbers, strict=True):
            laws[law] = DrivenLaw(
                metrics=dict.fromkeys(names, 0.1 * of),
                clean=np.ones(draws, bool),
                commands=[f"scripts/run.sh {law} {draw} --set 'ä'" for draw in range(draws)],
                hashes=["", *(f"{draw:064}" for draw in range(1, draws))],
            )
        made = DrivenCell(cell, laws)
        self._made.append(weakref.ref(made))
        self.most = max(self.most, sum(each() is not None for each in self._made))
        return made


@pytest.fixture
def result() -> BoardResult:
    return BoardResult(
        BOARD, LAWS, Invented(BOARD.cells("layout_1_8_c:all:*")), ["benchmark", "small"]
    )


def test_many_runs_stand_one_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: BoardResult
):
    for most in (run_files.MOST_IN_JSON, 1):
        (tmp_path / str(most)).mkdir()
        monkeypatch.setattr(run_files, "MOST_IN_JSON", most)
        run_files.write_runs(tmp_path / str(most), result)
    (whole,), (packed,) = tmp_path.glob("*/runs.json"), tmp_path.glob("*/runs.jsonl.gz")
    lines = gzip.decompress(packed.read_bytes()).splitlines()
    assert [*map(json.loads, lines)] == json.loads(whole.read_text())["runs"] == [*result.runs()]


def test_parquet_has_the_same_records(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: BoardResult
):
    """Rows come in groups.

    A field is empty if a manoeuvre does not measure it or it has no number. A first run without
    numbers, and with the name of a law from a file, fixes no kind of a column.
    """
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(run_files, "_ROWS_AT_ONCE", 7)
    run_files.write_runs(tmp_path, result)
    rows, runs = parquet.read_table(tmp_path / "runs.parquet").to_pylist(), [*result.runs()]
    assert rows == [{**dict.fromkeys(rows[0]), **run} for run in runs]
    assert set(rows[0]) == {name for run in runs for name in run}


def test_no_more_than_two_cells_are_held_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: BoardResult
):
    """Memory does not grow with the cells: one that is looked at while the next one is read."""
    monkeypatch.setattr(run_files, "MOST_IN_JSON", 1)
    result.as_json()
    cell_table(result)
    run_files.write_runs(tmp_path, result)
    assert len(result.cells) == 18
    assert result.cells.most == 2
