"""The full board takes hours.

Its page is held against the numbers that were kept of it, and some runs are driven.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from documentation.__main__ import main
from documentation.full_board import hold_against, kept, kept_board, write_kept
from documentation.full_board_tables import BUILT, PAGE, SCORES
from documentation.markdown import block_names, built_names
from ev_study.benchmark.board import Board, read_board
from ev_study.benchmark.driving import drive_law, laws_in_cell
from ev_study.benchmark.entry_speed import HASH
from ev_study.benchmark.ranking import run_files
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.scores import interquartile_mean
from ev_study.benchmark.ranking.tables import DIGITS
from ev_study.commands.benchmark import drive_board

ROOT = Path(__file__).parents[2]
BOARD = read_board("full")
# the board that was driven last
KEPT = replace(BOARD, version=kept()["version"], draws=kept()["draws"])
driven_whole = pytest.mark.skipif(
    KEPT.version < BOARD.version,
    reason=f"version {BOARD.version} of the full board has not been driven whole yet",
)
# a cell and a law: drives on two or four wheels, a search, split friction, the rig's tyre, an
# oracle
RUNS_DRIVEN = [
    ("audi_a2:front:friction_jump_in_bend:dry_to_wet", "all_known_neutral"),
    ("compact_ev:rear:lift_off_in_bend:wet", "predictive"),
    ("layout_1_8_c:all:double_lane_change:snow", "lqr_all_known"),
    ("mixed_motors:all:launch:split", "stability_by_drives"),
    ("racing_car:all:slow_ramp:dry", "super_twisting"),
]


@driven_whole
def test_page_is_of_the_board_as_it_is():
    """An edit of the board raises its version and asks for new runs.

    scripts/document.sh --full DIR writes their page.
    """
    hold_against(kept(), BOARD)


def test_page_is_of_the_laws_and_cells_of_the_board():
    """The page names the version of its numbers."""
    hold_against(kept(), KEPT)
    text = (ROOT / PAGE).read_text(encoding="utf-8")
    assert block_names(text) == [SCORES] and built_names(text) == list(BUILT)
    assert f"\nVersion {KEPT.version}: " in text


@driven_whole
@pytest.mark.parametrize(("place", "law"), RUNS_DRIVEN)
def test_first_draw_of_a_cell_has_the_hash_of_the_page(place: str, law: str):
    (cell,) = BOARD.cells(f"{place}:*")
    runs = laws_in_cell(BOARD, cell, [law])[law].only(0)
    _, found = drive_law(replace(BOARD, draws=1), cell, runs)
    signals = found[HASH][0]
    assert signals[:DIGITS] == kept()["cells"][cell.id("*")]["hashes"][list(BOARD.laws).index(law)]


@pytest.fixture(scope="module")
def few() -> Board:
    """A board of three cells, two laws and few draws."""
    small = read_board("small")
    laws = {law: small.laws[law] for law in (small.reference, "pi")}
    manoeuvres = {"step_steer": small.manoeuvres["step_steer"]}
    return replace(small, draws=5, cars=["compact_ev:rear"], manoeuvres=manoeuvres, laws=laws)


@pytest.fixture(scope="module")
def result(few: Board) -> BoardResult:
    return drive_board(few)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: BoardResult) -> Path:
    """Files that a board with many runs leaves behind."""
    monkeypatch.setattr(run_files, "MOST_IN_JSON", 0)
    (tmp_path / "board.json").write_text(
        json.dumps(result.as_json() | {"versions": {"python": "3"}})
    )
    run_files.write_runs(tmp_path, result)
    return tmp_path


def test_what_is_kept_are_the_numbers_of_the_runs(folder: Path, few: Board, result: BoardResult):
    """Kept numbers have four digits; over all three cells that of the car is the score."""
    found = kept_board(folder, few)
    assert found["laws"] == ["equal_torque", "pi"]
    for n, (cell, driven) in enumerate(zip(found["cells"], result.cells, strict=True)):
        of = found["cells"][cell]
        assert cell == driven.cell.id("*")
        for cost in ("handling", "energy"):
            assert of[cost] == pytest.approx(result.middles[cost][:, n], rel=5e-4)
        assert of["unstable"] == pytest.approx(result.unstable[:, n].mean(axis=-1), rel=5e-4)
        assert of["demand_met"] == pytest.approx(result.met[:, n].mean(axis=-1), rel=5e-4)
        assert of["hashes"] == [driven.laws[law].hashes[0][:DIGITS] for law in result.laws]
        assert set(of["medians"]) == set(driven.metrics["pi"])
        for name, medians in of["medians"].items():
            assert medians == pytest.approx(
                [np.median(driven.metrics[law][name]) for law in result.laws], rel=5e-4
            )
    for name, scores in result.scores.items():
        assert [found["scores"][law][name]["rank"] for law in result.laws] == [
            each.rank for each in scores
        ]
        assert found["where"]["compact_ev:rear"][name] == pytest.approx(
            [each.value for each in scores], rel=5e-4
        )
    for name, of in found["varied"].items():
        assert of["drawn"] == [result.varied[name].least, result.varied[name].most]
        for counted, laws in result.varied[name].differences.items():
            pairs = np.array(of[counted], float)
            assert pairs == pytest.approx(np.array(laws), rel=5e-4, nan_ok=True)
    best = {
        cost: float(interquartile_mean(of.min(axis=0).ravel())) for cost, of in result.costs.items()
    }
    assert {cost: found["best of each run"][cost] for cost in best} == pytest.approx(best, rel=5e-4)


def test_runs_of_another_board_are_refused(folder: Path, few: Board):
    lines = gzip.decompress((folder / "runs.jsonl.gz").read_bytes()).splitlines(keepends=True)
    for fewer, line in (
        (lines[:-1], "has not 5 runs of each law"),
        (lines[:-10], "has other cells than board.json"),
    ):
        (folder / "runs.jsonl.gz").write_bytes(gzip.compress(b"".join(fewer)))
        with pytest.raises(ValueError, match=line):
            kept_board(folder, few)
    others = replace(
        few, variations=[replace(few.variations[0], factor=[1.0, 1.1]), *few.variations[1:]]
    )
    for other, name in (
        (replace(few, seed=few.seed + 1), r"\*\.seed"),
        (others, r"\*\.vehicle\.mass"),
    ):
        with pytest.raises(
            ValueError, match=f"was not driven with the {name} that the board draws"
        ):
            kept_board(folder, other)


def refusal(root: Path, folder: Path) -> str:
    """The line about a folder that is no full board; nothing is written."""
    with pytest.raises(SystemExit) as found:
        main([str(root), "--full", str(folder)])
    assert not list(root.iterdir())
    return str(found.value)


def test_another_board_is_refused(folder: Path, tmp_path_factory: pytest.TempPathFactory):
    line = refusal(tmp_path_factory.mktemp("root"), folder)
    assert "board is small, wanted is full" in line and "\n" not in line


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda folder: (folder / "board.json").unlink(), "No such file or directory"),
        (
            lambda folder: (folder / "runs.jsonl.gz").write_bytes(b"\x1f\x8b"),
            "Compressed file ended",
        ),
        (lambda folder: (folder / "board.json").write_text("{}"), "'scores'"),
    ],
    ids=["none", "cut off", "foreign"],
)
def test_what_is_no_board_is_one_line(
    change: Callable[[Path], object],
    line: str,
    folder: Path,
    few: Board,
    tmp_path_factory,
    monkeypatch,
):
    monkeypatch.setattr("ev_study.benchmark.board.read_board", lambda _: few)
    change(folder)
    output = refusal(tmp_path_factory.mktemp("root"), folder)
    assert line in output and "\n" not in output


def test_a_part_of_the_full_board_is_refused():
    whole = kept()
    for name in ("laws", "cells"):
        with pytest.raises(ValueError, match=f"^{name} is "):
            hold_against(whole | {name: list(whole[name])[:-1]}, KEPT)
    with pytest.raises(ValueError, match=f"draws is 3, wanted is {KEPT.draws}"):
        hold_against(whole | {"draws": 3}, KEPT)


def test_a_number_that_no_run_has_is_kept_as_none(folder: Path, few: Board, tmp_path: Path):
    """A car that never gets there has no time; the file is read back as it was."""
    runs = [
        json.loads(line)
        for line in gzip.decompress((folder / "runs.jsonl.gz").read_bytes()).splitlines()
    ]
    for run in runs[:5]:
        run["yaw_rate_error"] = None
    (folder / "runs.jsonl.gz").write_bytes(gzip.compress("\n".join(map(json.dumps, runs)).encode()))
    found = kept_board(folder, few)
    assert next(iter(found["cells"].values()))["medians"]["yaw_rate_error"][0] is None
    write_kept(tmp_path / "kept.json", found)
    assert json.loads((tmp_path / "kept.json").read_text()) == found
