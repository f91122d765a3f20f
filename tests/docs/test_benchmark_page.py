"""The benchmark's page has the laws and cells of its board, and numbers of a repeated cell."""

import re
from pathlib import Path

import pytest

from documentation.benchmark_board import NAME, PAGE, drive_small, marked_cells
from ev_study.benchmark.board import read_board

TEXT = (Path(__file__).parents[2] / PAGE).read_text()
NUMBER = re.compile(r" \d+\.\d\d ")
CELL = "layout_1_8_c:all:step_steer:wet:*"


def test_page_has_every_law_and_cell():
    board = read_board(NAME)
    assert all(f"| `{law}` |" in TEXT for law in board.laws)
    assert [
        line.split("`")[1] for line in TEXT.splitlines() if line.startswith("| `") and ":v" in line
    ] == [cell.id("*") for cell in board.cells()]


@pytest.mark.weekly
def test_row_of_a_cell_is_what_its_runs_say():
    """A changed law or plant makes this fail: scripts/document.sh --runs docs/benchmark.md."""
    (row,) = marked_cells(drive_small(CELL)).splitlines()[2:]
    (written,) = [line for line in TEXT.splitlines() if line.startswith(f"| `{CELL}")]
    assert written.count("`") == 6  # id, first digits of the signal hash, command
    assert NUMBER.sub("", written) == NUMBER.sub("", row)
    numbers, found = ([float(number) for number in NUMBER.findall(text)] for text in (written, row))
    # another processor may round the last digit differently
    assert numbers == pytest.approx(found, abs=0.0101)
