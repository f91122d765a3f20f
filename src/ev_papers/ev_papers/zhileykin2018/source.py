"""How what the source published (published.csv) is judged and drawn."""

from __future__ import annotations

from ev_papers.zhileykin2018 import equations, paper, runs
from ev_papers.zhileykin2018.panels import PANELS

__all__ = ["DECLARATIONS", "ORDER", "PANELS"]

ORDER = 4  # among the sources, in tables
DECLARATIONS = (
    *paper.DECLARATIONS,
    *runs.DECLARATIONS,
    *equations.DECLARATIONS,
)
