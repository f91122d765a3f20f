"""The rows of docs/verdicts.md, and the numbers that are kept for them, are those of the runs."""

import re
from pathlib import Path

import pytest
from helpers.judging import driven

from documentation.measured import is_long, read_measured, sample
from documentation.verdict_tables import COUNTS, FILE, PAGE, count_table, kept, row
from ev_study.studies.driving import drive_cases
from ev_study.studies.study import study_named
from ev_study.verdicts.need import Driven, Need, StudyNeed, cases_of
from ev_study.verdicts.sources import Published, published, sources
from ev_study.verdicts.verdict import markdown_row, verdict, wanted

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / PAGE).read_text()
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
ALL, QUICK = wanted((), quick=False), wanted((), quick=True)
SLOW = [each for each in ALL if each not in QUICK]


def test_each_id_is_kept_once():
    assert list(kept()) == [id for source in sources() for id in published(source)]
    assert len((ROOT / FILE).read_text().splitlines()) == len(kept()) + 1


def test_counts_are_those_of_the_rows():
    written = TEXT.partition(f"<!-- generated: {COUNTS} -->\n")[2].partition("<!--")[0]
    assert written.strip() == count_table().strip()


@pytest.mark.parametrize("of", [each for _, each in QUICK], ids=lambda of: of.id)
def test_row_is_what_the_runs_say(of: Published):
    compare(of)


@pytest.mark.slow
@pytest.mark.parametrize("of", [each for _, each in SLOW], ids=lambda of: of.id)
def test_row_is_what_longer_runs_say(of: Published):
    compare(of)


LONG_STUDIES = list(dict.fromkeys(need for _, each in ALL for need in each.needs if is_long(need)))


@pytest.mark.slow
@pytest.mark.parametrize("study", LONG_STUDIES, ids=[study.command for study in LONG_STUDIES])
@pytest.mark.sampled
def test_measured_numbers_of_a_long_study_are_those_of_its_cases(study: StudyNeed):
    """1e-6: another processor may add up a recording in another order."""
    kept = read_measured(ROOT, study).results
    assert list(kept) == [case.name for case in cases_of(study)]
    for now in drive_cases(sample(study), study_named(study.study).measure):
        for name, value in kept[now.name].measured.items():
            if value is None:  # there is nothing to measure
                assert now.measured[name] is None, (now.name, name)
                continue
            assert value == pytest.approx(now.measured[name], rel=1e-6, abs=1e-9, nan_ok=True), (
                now.name,
                name,
            )


def given(need: Need) -> Driven:
    """Results of a need; those of a long study come from its file."""
    return (
        read_measured(ROOT, need) if isinstance(need, StudyNeed) and is_long(need) else driven(need)
    )


def compare(of: Published) -> None:
    """Numbers, not text: another processor may round the last digit differently."""
    written, now = row(of), markdown_row(verdict(of, [given(need) for need in of.needs]))
    assert NUMBER.sub("", written) == NUMBER.sub("", now), (
        "run scripts/document.sh --runs docs/verdicts.md"
    )
    numbers = [float(number) for number in NUMBER.findall(written)]
    assert numbers == pytest.approx([float(n) for n in NUMBER.findall(now)], rel=1e-3, abs=1e-9)
