"""The tables of docs/verdicts.md, from what the repository keeps of the verdicts: docs/measured/verdicts.csv.

How it works: a row of the table is what a source published and what came out. The first is in the
list of the source. Of the second the file keeps a line for each id: the sort of the verdict and our
numbers, and the texts of tolerance and note if numbers of runs are filled into them. Tests hold the
rows that follow against the runs. The repository's page has the counts, the built page has the rows
too.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from documentation.markdown import table, with_blocks
from documentation.measured import FOLDER, ROOT, is_long, write_measured
from ev_stack.measures.metric import FROM_INPUTS, NOT_MEASURED, NOT_REPRODUCED, REPRODUCED
from ev_study.verdicts.sources import IN_PART, KINDS, NO_VERDICT, Published, published, sources
from ev_study.verdicts.verdict import (
    SORTS,
    WITH_ASSUMPTION,
    WITH_FIT,
    Verdict,
    markdown_row,
    markdown_table,
    sort_of,
)

PAGE = "docs/verdicts.md"
FILE = f"{FOLDER}/verdicts.csv"
COUNTS = "verdict counts"
NAMES = (PAGE, *(f"{PAGE}#{source}" for source in sources()))  # that document.sh --runs knows
COLUMNS = ("id", "verdict", "ours", "tolerance", "note")
_WITHOUT_FIT = (REPRODUCED, WITH_ASSUMPTION)
_HOLD = (*_WITHOUT_FIT, WITH_FIT, IN_PART)
_WITH_NUMBERS = ("printed", "follows", "axes")  # the kinds of which the source has numbers
_BEFORE_NOTE = {
    WITH_ASSUMPTION: " ",
    **dict.fromkeys(
        (WITH_FIT, FROM_INPUTS, IN_PART, NOT_REPRODUCED, *NO_VERDICT, NOT_MEASURED), ": "
    ),
}

Line = Mapping[str, str]  # of the file, by column


@dataclass(frozen=True, slots=True)
class KeptVerdict:
    """A verdict as a row of the table needs it."""

    published: Published
    ours: str
    tolerance: str
    text: str
    run: str

    @classmethod
    def of(cls, what: Published, line: Line) -> KeptVerdict:
        """The verdict on an id of which this line is kept."""
        note = line["note"] or _plain_note(what)
        sort = line["verdict"]
        text = f"{sort}{_BEFORE_NOTE[sort]}{note}" if note and sort in _BEFORE_NOTE else sort
        tolerance = line["tolerance"] or _plain_tolerance(what)
        return cls(what, line["ours"], tolerance, text, Verdict(what, {}, {}, "").run)


def line_of(of: Verdict) -> Line:
    """What is kept of a verdict."""
    sort, what = sort_of(of.text), of.published
    note = of.text.removeprefix(f"{sort}{_BEFORE_NOTE[sort]}") if sort in _BEFORE_NOTE else ""
    return {
        "id": what.id,
        "verdict": sort,
        "ours": of.ours,
        "tolerance": "" if of.tolerance == _plain_tolerance(what) else of.tolerance,
        "note": "" if note == _plain_note(what) else note,
    }


def _plain_tolerance(of: Published) -> str:
    """Tolerances with their reasons, empty if numbers of runs are filled into them."""
    if not all(check.tolerance.is_plain and check.why.is_plain for check in of.checks):
        return ""
    return "; ".join(dict.fromkeys(check.allowed(()) for check in of.checks))


def _plain_note(of: Published) -> str:
    """The text of the note, empty if numbers of runs are filled into it."""
    return of.text.filled(()) if of.text.is_plain else ""


@cache
def kept(root: Path = ROOT) -> dict[str, Line]:
    """The lines of the file by id."""
    with (root / FILE).open(encoding="utf-8", newline="") as file:
        return {line["id"]: line for line in csv.DictReader(file)}


def write_kept(root: Path, lines: Mapping[str, Line]) -> None:
    """Write the file anew, in the order of the sources."""
    with (root / FILE).open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            lines[id] for source in sources() for id in published(source) if id in lines
        )
    kept.cache_clear()


def write_verdicts(root: Path, wanted: Sequence[str]) -> None:
    """Drive what the verdicts on all sources, or on those wanted, need; write what is kept of them, and the counts."""
    from ev_study.commands.verdicts import judge_driven

    lines = dict(kept(root))
    for source in sources():
        if PAGE in wanted or f"{PAGE}#{source}" in wanted:
            found, driven = judge_driven([source])
            lines.update({each.published.id: line_of(each) for each in found})
            for need, cases in driven.items():
                if is_long(need):
                    write_measured(root, need, cases)
    write_kept(root, lines)
    page = root / PAGE
    page.write_text(
        with_blocks(page.read_text(encoding="utf-8"), {COUNTS: count_table()}), encoding="utf-8"
    )
    print(f"written: {FILE}, {page.name}")


def source_table(source: str) -> str:
    """The rows of a source."""
    return markdown_table(
        [KeptVerdict.of(each, kept()[id]) for id, each in published(source).items()]
    )


def row(of: Published) -> str:
    """The row of an id."""
    return markdown_row(KeptVerdict.of(of, kept()[of.id]))


def count_table() -> str:
    """Verdicts of each sort and source, and their sums."""
    sorts = {id: line["verdict"] for id, line in kept().items()}
    lines = [
        (source, Counter(sorts[id] for id in published(source) if id in sorts))
        for source in sources()
    ]
    lines.append(("all", Counter(sorts.values())))
    used = [sort for sort in SORTS if lines[-1][1][sort]]
    cells = [
        (source, str(found.total()), *(str(found[sort]) for sort in used))
        for source, found in lines
    ]
    by_source = table(("source", "ids", *used), cells)
    return "\n".join((by_source, _table_of_kinds(sorts), _sentence_of_printed(sorts), ""))


def _sentence_of_printed(sorts: Mapping[str, str]) -> str:
    """How many of the printed numbers a run reproduces without a number that was fitted."""
    printed = [
        each.id
        for source in sources()
        for each in published(source).values()
        if each.kind == "printed"
    ]
    without_fit = [id for id in printed if sorts.get(id) in _WITHOUT_FIT]
    named = ", ".join(f"`{id}`" for id in without_fit)
    counted = Counter(sorts.get(id) for id in printed)
    others = ", ".join(
        f"{counted[sort]} {sort}" for sort in SORTS if counted[sort] and sort not in _WITHOUT_FIT
    )
    return (
        f"**A run without a fitted number reproduces {len(without_fit)} of the {len(printed)} ids"
        f" whose number is printed{f': {named}' if named else ''}.** The others: {others}."
    )


def _table_of_kinds(sorts: Mapping[str, str]) -> str:
    """What is reproduced by kind, and how many different numbers of the source: one may stand in several tables.

    Words have none: what they are held against is a threshold of ours.
    """
    cells = []
    for kind in KINDS:
        of_kind = [
            (source, each)
            for source in sources()
            for each in published(source).values()
            if each.kind == kind
        ]
        counts = [sum(sorts.get(each.id) == sort for _, each in of_kind) for sort in _HOLD]
        numbers = {
            (source, check.value, check.unit)
            for source, each in of_kind
            if sorts.get(each.id) in _HOLD
            for check in each.checks
            if check.value is not None
        }
        cells.append(
            (
                kind,
                str(len(of_kind)),
                *map(str, counts),
                str(len(numbers)) if kind in _WITH_NUMBERS else "–",
            )
        )
    return table(("kind", "ids", *_HOLD, "different numbers of these"), cells)
