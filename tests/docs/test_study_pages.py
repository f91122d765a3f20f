"""The tables of studies on the pages are what their cases have measured."""

from pathlib import Path

import pytest

from documentation.asr_seeds import seed_tables
from documentation.markdown import with_blocks
from documentation.measured import is_long, read_measured, sample
from documentation.scenario_results import LONG_TABLES, STUDY_PAGES, study_table
from ev_study.studies.driving import drive_cases
from ev_study.studies.study import study_named
from ev_study.verdicts.need import StudyNeed

ROOT = Path(__file__).parents[2]
STUDIES = [(page, study) for page, studies in STUDY_PAGES.items() for study in studies]
# Those of the page; others are in the built pages alone.
KEPT = [(page, study) for page, study in STUDIES if study not in LONG_TABLES.get(page, ())]
# tests/docs/test_verdicts_page.py drives some of their cases
IN_VERDICTS = ("five_methods", "outside_friction", "outside_laws", "outside_lap")


@pytest.mark.parametrize(("page", "study"), KEPT)
def test_table_is_that_of_the_measured_numbers(page: str, study: str):
    text = (ROOT / page).read_text(encoding="utf-8")
    results = read_measured(ROOT, StudyNeed(study)).results
    assert is_long(StudyNeed(study))
    assert with_blocks(text, {study: study_table(study, results)}) == text, (
        f"run scripts/document.sh --runs {page}"
    )


@pytest.mark.slow
@pytest.mark.parametrize("study", [study for _, study in STUDIES if study not in IN_VERDICTS])
@pytest.mark.sampled
def test_measured_numbers_are_those_of_the_cases(study: str):
    """A changed law shows here.

    1e-6, for another processor may add up a recording in another order.
    """
    kept = read_measured(ROOT, StudyNeed(study)).results
    for now in drive_cases(sample(StudyNeed(study)), study_named(study).measure):
        for name, value in kept[now.name].measured.items():
            same = value if value is None else pytest.approx(value, rel=1e-6, abs=1e-9, nan_ok=True)
            assert now.measured[name] == same, (now.name, name)


def test_spread_over_seeds_is_that_of_the_page():
    """Two controls on dry asphalt, and one of them with the slip of the road's peak as target."""
    text = (
        (ROOT / "docs" / "asr.md")
        .read_text(encoding="utf-8")
        .partition("<!-- generated: seeds -->")[2]
    )
    written = [line.split(" | ") for line in text.partition("<!-- end")[0].splitlines()]
    for line in seed_tables(("dry",), ("slip_window", "pi_slip")).splitlines():
        name, *cell = line.rstrip(" |").split(" | ")
        if "±" in line:
            assert any(row[0] == name and row[4] == cell[0] for row in written), line
