"""The tables of docs/verdicts.md: one for each source, and how many verdicts of each sort there are."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from documentation.markdown import table, with_blocks
from documentation.measured import is_long, write_measured
from ev_sim.measures.metric import REPRODUCED
from ev_study.verdicts.sources import IN_PART, KINDS, published, sources
from ev_study.verdicts.verdict import SORTS, WITH_ASSUMPTION, markdown_table, sort_of

PAGE = "docs/verdicts.md"
COUNTS = "verdict counts"
PARTS = (COUNTS, *(f"verdicts of {source}" for source in sources()))
NAMES = (PAGE, *(f"{PAGE}#{source}" for source in sources()))  # that document.sh --runs knows
_ROW = re.compile(r"^\| `(?P<id>[\w.]+)` \|(?P<cells>.*)\|$", re.MULTILINE)
_VERDICT = -2  # place of its cell
_HOLD = (REPRODUCED, WITH_ASSUMPTION, IN_PART)
_WITH_NUMBERS = ("printed", "follows", "axes")  # the kinds of which the source has numbers


def write_verdicts(root: Path, wanted: Sequence[str]) -> None:
    """Drive what the verdicts on all sources, or on those wanted, need, and write their tables and the counts."""
    from ev_study.commands.verdicts import judge_driven

    page = root / PAGE
    text = page.read_text(encoding="utf-8")
    for source in sources():
        if PAGE in wanted or f"{PAGE}#{source}" in wanted:
            found, driven = judge_driven([source])
            text = with_blocks(text, {f"verdicts of {source}": markdown_table(found)})
            for need, cases in driven.items():
                if is_long(need):
                    write_measured(root, need, cases)
    page.write_text(with_blocks(text, {COUNTS: count_table(text)}), encoding="utf-8")
    print(f"written: {page.name}")


def rows(page: str) -> dict[str, str]:
    """The line of each id on the page."""
    return {match["id"]: match[0] for match in _ROW.finditer(page)}


def count_table(page: str) -> str:
    """Verdicts of each sort and source on the page, and their sums."""
    sorts = _sorts(page)
    lines = [(source, Counter(sorts[id] for id in published(source) if id in sorts)) for source in sources()]
    lines.append(("all", Counter(sorts.values())))
    used = [sort for sort in SORTS if lines[-1][1][sort]]
    cells = [(source, str(found.total()), *(str(found[sort]) for sort in used)) for source, found in lines]
    return "\n".join((table(("source", "ids", *used), cells), _table_of_kinds(sorts)))


def _sorts(page: str) -> dict[str, str]:
    return {id: sort_of(line.split(" | ")[_VERDICT]) for id, line in rows(page).items()}


def _table_of_kinds(sorts: Mapping[str, str]) -> str:
    """What is reproduced by kind, and how many different numbers of the source: one may stand in several tables.

    Words have none: what they are held against is a threshold of ours.
    """
    cells = []
    for kind in KINDS:
        of_kind = [(source, each) for source in sources() for each in published(source).values() if each.kind == kind]
        counts = [sum(sorts.get(each.id) == sort for _, each in of_kind) for sort in _HOLD]
        numbers = {
            (source, check.value, check.unit)
            for source, each in of_kind
            if sorts.get(each.id) in _HOLD
            for check in each.checks
            if check.value is not None
        }
        cells.append((kind, str(len(of_kind)), *map(str, counts), str(len(numbers)) if kind in _WITH_NUMBERS else "–"))
    return table(("kind", "ids", *_HOLD, "different numbers of these"), cells)
