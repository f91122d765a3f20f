"""scripts/document.sh [--runs | --check]"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ev_sim.documentation.markdown import with_blocks
from ev_sim.documentation.pages import RESULTS, stale_pages


def main(argv: list[str] | None = None) -> None:
    """Write the generated parts of README.md and docs/ anew; exit status 1 if --check finds one that is stale."""
    parser = argparse.ArgumentParser(prog="document.sh", description="Write the generated parts of the pages.")
    parser.add_argument("root", type=Path, help="top of the repository")
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--runs", action="store_true", help="also drive the scenarios for the results and the images")
    way.add_argument("--check", action="store_true", help="change nothing, name the stale pages")
    given = parser.parse_args(argv)
    stale = stale_pages(given.root)
    for page, text in stale.items():
        print(f"{'stale' if given.check else 'written'}: {page.relative_to(given.root)}")
        if not given.check:
            page.write_text(text, encoding="utf-8")
    if given.runs:
        _write_results(given.root)
    if given.check and stale:
        sys.exit(1)


def _write_results(root: Path) -> None:
    from ev_sim.documentation import results, scenario_results

    images = root / "docs" / "images"
    images.mkdir(exist_ok=True)
    driven = results.drive_all()
    _write(root / "docs" / "shchur2019.md", {RESULTS: results.result_table(driven)})
    results.save_images(driven, images)
    for name, page in scenario_results.SCENARIO_PAGES.items():
        run = results.drive(page.scenario)
        texts = {RESULTS: scenario_results.results_of(page, run)}
        scenario_results.save_images(page, run, images)
        if page.sweep:
            cases = scenario_results.drive_sweep(page.sweep)
            texts[page.sweep] = scenario_results.sweep_table(page.sweep, cases)
            scenario_results.save_sweep_images(page.sweep, cases, images)
        _write(root / name, texts)
    for name, study in scenario_results.STUDY_PAGES.items():
        cases = scenario_results.drive_sweep(study)
        scenario_results.save_sweep_images(study, cases, images)
        _write(root / name, {study: scenario_results.sweep_table(study, cases)})


def _write(page: Path, texts: dict[str, str]) -> None:
    page.write_text(with_blocks(page.read_text(encoding="utf-8"), texts), encoding="utf-8")
    print(f"written: results in {page.name}, images")


if __name__ == "__main__":
    main()
