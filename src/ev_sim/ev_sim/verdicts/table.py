"""Verdicts as a table for the terminal, as Markdown and as JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from ev_sim.recording.files_of_run import atomic_file
from ev_sim.report.tables import text_table
from ev_sim.verdicts.verdict import SORTS, Verdict, sort_of

FILES = ("verdicts.json", "verdicts.md")
COLUMNS = ("id", "kind", "what", "printed", "ours", "tolerance", "verdict", "driven")
_SHORT = ("id", "verdict", "ours")


def plain_table(verdicts: Sequence[Verdict], width: int) -> str:
    """Id, sort of verdict and numbers, cut to `width` characters; the files have the rest."""
    rows = [(each.published.id, sort_of(each.text), each.ours) for each in verdicts]
    return "\n".join(
        line if len(line) <= width else f"{line[: width - 1].rstrip()}…"
        for line in (line.rstrip() for line in text_table(_SHORT, rows, left=_SHORT).splitlines())
    )


def counts(verdicts: Sequence[Verdict]) -> str:
    """How many verdicts there are of each sort, in one line."""
    found = Counter(sort_of(each.text) for each in verdicts)
    return ", ".join([f"{len(verdicts)} ids", *(f"{found[sort]} {sort}" for sort in SORTS if found[sort])])


def markdown_table(verdicts: Sequence[Verdict]) -> str:
    """Everything about each id, one line each."""
    return "\n".join([_line(COLUMNS), _line(["---"] * len(COLUMNS)), *map(markdown_row, verdicts)]) + "\n"


def markdown_row(of: Verdict) -> str:
    """The line of one id."""
    what = of.published
    return _line((f"`{what.id}`", what.kind, what.quantity, what.printed, of.ours, of.tolerance, of.text, of.run))


def write(verdicts: Sequence[Verdict], folder: Path, images: Mapping[str, Sequence[str]]) -> None:
    """Write verdicts.json and verdicts.md; `images` are those of scripts/run.sh figures that show an id."""
    entries = [{**each.as_json(), "figures": list(images.get(each.published.id, ()))} for each in verdicts]
    content = json.dumps(entries, indent=2, allow_nan=False, ensure_ascii=False)
    for name, text in zip(FILES, (content + "\n", markdown_table(verdicts)), strict=True):
        with atomic_file(folder / name) as file:
            file.write(text.encode())


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
