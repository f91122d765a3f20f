"""The table of docs/measured.md: every comparison with measurement whose number is kept, and its verdict.

docs/measured/comparisons.csv has a row for each: what, its number and unit, the largest or the least that holds (`most`
or `least`, the other is empty), why that, and the command that gives it. The data are not ours to commit.
"""

from __future__ import annotations

import csv
from pathlib import Path

from documentation.markdown import table

FILE = Path(__file__).parents[2] / "docs" / "measured" / "comparisons.csv"


def comparison_table() -> str:
    """One row for each comparison; ValueError for one without a limit."""
    with FILE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return table(
        ("what", "number", "holds", "verdict", "why this limit", "command"),
        [
            (
                row["what"],
                f"{row['value']} {row['unit']}",
                f"at most {row['most']}" if row["most"] else f"at least {row['least']}",
                verdict(row),
                row["reason"],
                f"`{row['command']}`",
            )
            for row in rows
        ],
    )


def verdict(row: dict[str, str]) -> str:
    """Whether the number of a row keeps its limit."""
    value = float(row["value"])
    if row["most"]:
        return "holds" if value <= float(row["most"]) else "does not hold"
    return "holds" if value >= float(row["least"]) else "does not hold"
