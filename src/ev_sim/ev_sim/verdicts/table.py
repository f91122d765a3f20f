"""Verdicts as a table for the terminal, as Markdown and as JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ev_sim.report.text_table import text_table
from ev_sim.run.recording.atomic import atomic_file
from ev_sim.verdicts.verdict import Verdict

COLUMNS = ("id", "kind", "what", "printed", "ours", "tolerance", "verdict", "driven")
_SHORT = ("id", "ours", "verdict")


def plain_table(verdicts: Sequence[Verdict]) -> str:
    """Id, number and verdict, for the terminal."""
    return text_table(_SHORT, [(each.published.id, each.ours, each.text) for each in verdicts], left=_SHORT)


def counts(verdicts: Sequence[Verdict]) -> str:
    """How many verdicts there are of each sort, in one line."""
    sorts = Counter(sort(each) for each in verdicts)
    return ", ".join([f"{len(verdicts)} ids", *(f"{number} {name}" for name, number in sorts.most_common())])


def sort(of: Verdict) -> str:
    """The verdict without what is particular to the id."""
    return f"{of.judgement} with assumption" if of.judgement == "reproduced" and of.assumption else of.judgement


def markdown_table(verdicts: Sequence[Verdict]) -> str:
    """Everything about each id, one line each."""
    lines = [_line(COLUMNS), _line(["---"] * len(COLUMNS))]
    for each in verdicts:
        of = each.published
        cells = (f"`{of.id}`", of.kind, of.quantity, of.printed, each.ours, each.tolerance, each.text, each.run)
        lines.append(_line(cells))
    return "\n".join(lines) + "\n"


def write(verdicts: Sequence[Verdict], folder: Path) -> None:
    """Write verdicts.json and verdicts.md."""
    content = json.dumps([each.as_json() for each in verdicts], indent=2, allow_nan=False, ensure_ascii=False)
    for name, text in (("verdicts.json", content + "\n"), ("verdicts.md", markdown_table(verdicts))):
        with atomic_file(folder / name) as file:
            file.write(text.encode())


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
