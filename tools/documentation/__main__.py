"""scripts/document.sh [--runs [PAGE ...] | --full DIR | --pages | --check]"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from documentation.benchmark_board import (
    IMAGE,
    TUNED,
    board_tables,
    drive_small,
    held_out_table,
)
from documentation.benchmark_board import PAGE as BENCHMARK
from documentation.hashes import HASHES, all_hashes, changes, hash_table, published_hashes
from documentation.law_costs import BLOCK as LAW_COSTS
from documentation.law_costs import NATIVE, law_table
from documentation.markdown import with_blocks
from documentation.pages import CONTROL_PERIODS, README, RESULTS, SHCHUR, stale_pages
from documentation.processors import BLOCK, PROCESSORS, processor_table
from documentation.site import BUILT, gather
from documentation.verdict_tables import NAMES, write_verdicts
from ev_msgs_py.refusal import unknown_name


def main(argv: list[str] | None = None) -> None:
    """Write the generated parts of docs/ anew, and all pages whole; exit status 1 if --check finds a stale part."""
    parser = argparse.ArgumentParser(
        prog="document.sh",
        description="Write the generated parts of the pages, and all pages whole.",
    )
    parser.add_argument("root", type=Path, help="top of the repository")
    way = parser.add_mutually_exclusive_group()
    way.add_argument(
        "--runs",
        nargs="*",
        metavar="PAGE",
        help=(
            "also drive the scenarios and studies for the results and the images, of all pages or"
            " of these"
        ),
    )
    way.add_argument(
        "--full",
        type=Path,
        metavar="DIR",
        help="also keep what `run.sh benchmark full --out DIR` has left",
    )
    way.add_argument(
        "--pages", action="store_true", help=f"only write all pages, whole, to {BUILT}"
    )
    way.add_argument("--check", action="store_true", help="change nothing, name the stale pages")
    given = parser.parse_args(argv)
    if given.pages:
        _build(given.root)
        return
    if given.full is not None:
        _keep_full(given.root, given.full)
    stale = stale_pages(given.root)
    for page, text in stale.items():
        print(f"{'stale' if given.check else 'written'}: {page.relative_to(given.root)}")
        if not given.check:
            page.write_text(text, encoding="utf-8")
    if given.runs is not None:
        _write_results(given.root, given.runs)
    if not given.check:
        _build(given.root)
    elif stale:
        sys.exit(1)


def _build(root: Path) -> None:
    """Write all pages anew, with the parts that the repository does not keep."""
    shutil.rmtree(root / BUILT, ignore_errors=True)
    gather(root, root / BUILT)
    print(f"written: {BUILT}")


def _write_results(root: Path, chosen: Sequence[str]) -> None:
    from pictures.split_friction import save_moving_picture
    from pictures.writing import save_pictures

    from documentation import results, scenario_results
    from documentation.images import save_small
    from ev_study.benchmark.ranking.drawing import board_sheet

    images = root / "docs" / "images"
    images.mkdir(exist_ok=True)
    held_out = f"{BENCHMARK}#{TUNED}"
    known = [README, HASHES, PROCESSORS, NATIVE, SHCHUR, BENCHMARK, held_out, *NAMES]
    known += [*scenario_results.SCENARIO_PAGES, *scenario_results.STUDY_PAGES]
    for name in chosen:
        if name not in known:
            raise unknown_name("page with results", name, known)
    wanted = chosen or known
    if README in wanted:
        save_moving_picture(images)
        save_pictures(images)
    if HASHES in wanted:
        _write_hashes(root / HASHES)
    if PROCESSORS in wanted:
        published = published_hashes((root / HASHES).read_text(encoding="utf-8"))
        _write(root / PROCESSORS, {BLOCK: processor_table(published)})
    if NATIVE in wanted:
        _write(root / NATIVE, {LAW_COSTS: law_table()})
    if SHCHUR in wanted:
        driven = results.drive_all()
        texts = {
            RESULTS: results.result_table(driven),
            CONTROL_PERIODS: results.control_period_table(),
        }
        _write(root / SHCHUR, texts)
        results.save_images(driven, images)
    if BENCHMARK in wanted:
        board = drive_small()
        _write(root / BENCHMARK, board_tables(board))
        save_small({IMAGE: board_sheet(board)}, images)
    if held_out in wanted:
        _write(root / BENCHMARK, {TUNED: held_out_table()})
    if any(name in wanted for name in NAMES):
        write_verdicts(root, wanted)
    for name, page in scenario_results.SCENARIO_PAGES.items():
        if name in wanted:
            run = results.drive(page.scenario)
            texts = {RESULTS: scenario_results.results_of(page, run)}
            texts.update({part: table() for part, table in page.tables.items()})
            scenario_results.save_images(page, run, images)
            _write(root / name, {**texts, **_studied(root, page.studies, images)})
    for name, studies in scenario_results.STUDY_PAGES.items():
        if name in wanted:
            further = {
                part: table() for part, table in scenario_results.STUDY_TABLES.get(name, {}).items()
            }
            _write(root / name, {**_studied(root, studies, images), **further})


def _keep_full(root: Path, folder: Path) -> None:
    from documentation.full_board import FILE, kept_board, write_kept
    from documentation.full_board_tables import IMAGE
    from documentation.images import save_image
    from ev_study.benchmark.board import read_board

    try:
        kept = kept_board(folder, read_board("full"))
        save_image(folder / "board.png", root / "docs" / "images" / f"{IMAGE}.png")
    except (OSError, EOFError, LookupError, ValueError) as problem:
        sys.exit(
            f"--full {folder}: {problem}, expected what `scripts/run.sh benchmark full --out DIR`"
            " leaves in DIR"
        )
    write_kept(root / FILE, kept)


def _write_hashes(page: Path) -> None:
    before, now = published_hashes(page.read_text(encoding="utf-8")), all_hashes()
    moved = changes(before, now)
    print("\n".join(moved) or "no hash has changed")
    _write(page, {RESULTS: hash_table(now)})


def _studied(root: Path, studies: Sequence[str], images: Path) -> dict[str, str]:
    """The table of each study; its figures go to the images."""
    from documentation import scenario_results

    texts = {}
    for study in studies:
        cases = scenario_results.drive_study(study, root)
        scenario_results.save_study_images(study, cases, images)
        texts[study] = scenario_results.study_table(study, cases)
    return texts


def _write(page: Path, texts: dict[str, str]) -> None:
    page.write_text(with_blocks(page.read_text(encoding="utf-8"), texts), encoding="utf-8")
    print(f"written: results in {page.name}")


if __name__ == "__main__":
    main()
