"""docs/verdicts.md says what the runs say."""

import re
from pathlib import Path

import pytest
from judging import driven

from documentation.verdict_tables import COUNTS, PAGE, count_table, rows
from ev_sim.verdicts.all_verdicts import SOURCES, declarations, verdicts, wanted
from ev_sim.verdicts.declaration import Declaration
from ev_sim.verdicts.table import markdown_row

TEXT = (Path(__file__).parents[2] / PAGE).read_text()
ROWS = rows(TEXT)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
ALL, QUICK = wanted((), quick=False), wanted((), quick=True)
SLOW = [each for each in ALL if each not in QUICK]


def test_page_has_one_row_for_each_id():
    assert list(ROWS) == [id for source in SOURCES for id in declarations(source)]
    assert len(ROWS) == len(re.findall(r"^\| `[a-z]+\.", TEXT, re.MULTILINE))


def test_counts_are_those_of_the_rows():
    written = TEXT.partition(f"<!-- generated: {COUNTS} -->\n")[2].partition("<!--")[0]
    assert written.strip() == count_table(TEXT).strip()


@pytest.mark.parametrize("source, declaration", QUICK, ids=[each.id for _, each in QUICK])
def test_row_is_what_the_runs_say(source: str, declaration: Declaration):
    compare(source, declaration)


@pytest.mark.slow
@pytest.mark.parametrize("source, declaration", SLOW, ids=[each.id for _, each in SLOW])
def test_row_is_what_longer_runs_say(source: str, declaration: Declaration):
    compare(source, declaration)


def compare(source: str, declaration: Declaration) -> None:
    """Numbers, not text: another processor may round the last digit differently."""
    (found,) = verdicts([(source, declaration)], {need: driven(need) for need in declaration.needs})
    written, now = ROWS[declaration.id], markdown_row(found)
    assert NUMBER.sub("", written) == NUMBER.sub("", now), "run scripts/document.sh --runs docs/verdicts.md"
    numbers = [float(number) for number in NUMBER.findall(written)]
    assert numbers == pytest.approx([float(n) for n in NUMBER.findall(now)], rel=1e-3, abs=1e-9)
