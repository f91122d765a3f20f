"""The table of docs/measured.md: every comparison with measurement whose number is kept, and its verdict.

docs/measured/comparisons.csv has id and value, as `scripts/run.sh verdicts --data DIR` leaves them
behind; the data are not ours to commit. What is compared with which limit is declared in
config/measured/comparisons.csv.
"""

from __future__ import annotations

import csv
from pathlib import Path

from documentation.markdown import table
from ev_study.measured.comparisons.comparison import COLUMNS, rows

FILE = Path(__file__).parents[2] / "docs" / "measured" / "comparisons.csv"


def comparison_table() -> str:
    """One row for each comparison."""
    with FILE.open(encoding="utf-8", newline="") as file:
        return table(
            COLUMNS, rows({row["id"]: float(row["value"]) for row in csv.DictReader(file)})
        )
