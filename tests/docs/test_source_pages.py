"""The generated results of the pages about Ge & Ni and Tatar & Chudzik are those of the runs."""

import re
from pathlib import Path

import pytest
from helpers.judging import drive_here
from helpers.source_runs import driven

from documentation.scenario_results import SCENARIO_PAGES, results_of, study_table
from ev_study.studies.run_study import arguments
from ev_study.studies.study import study_named

ROOT = Path(__file__).parents[2]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


@pytest.mark.parametrize("page", ["docs/ge_ni2005.md", "docs/tatar_chudzik.md"])
def test_results_of_the_page_are_those_of_the_runs(page: str):
    """A changed law makes this fail: scripts/document.sh --runs PAGE writes the new ones."""
    compare(
        written(page, "results"),
        results_of(SCENARIO_PAGES[page], driven(SCENARIO_PAGES[page].scenario)),
    )


@pytest.mark.parametrize("page", ["docs/ge_ni2005.md", "docs/tatar_chudzik.md"])
def test_no_row_of_the_page_is_empty(page: str):
    """A judged number without a column for its case would be a row without numbers."""
    named = re.findall(r"^\| `[\w.*,]+` \|(.*)\|$", written(page, "results"), re.MULTILINE)
    assert named and all(NUMBER.search(cells) for cells in named)


def test_control_periods_of_the_page_are_those_of_the_study():
    name = "ge_ni2005_periods"
    study = study_named(name)
    cases = study.cases(arguments(name, ()))
    results = {result.name: result for result in drive_here(cases, [study.measure] * len(cases))}
    compare(written("docs/ge_ni2005.md", name), study_table(name, results))


def written(page: str, part: str) -> str:
    """A generated part of a page."""
    text = (ROOT / page).read_text()
    return text.partition(f"<!-- generated: {part} -->\n")[2].partition(
        "<!-- end of generated -->"
    )[0]


def compare(written: str, now: str) -> None:
    """Numbers, not text: another processor may round the last digit differently."""
    assert NUMBER.sub("", written).strip() == NUMBER.sub("", now).strip()
    numbers, found = ([float(number) for number in NUMBER.findall(text)] for text in (written, now))
    assert numbers == pytest.approx(found, rel=2e-3, abs=1e-9)
