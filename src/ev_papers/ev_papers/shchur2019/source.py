"""How what the source published (published.csv) is judged and drawn."""

from __future__ import annotations

from ev_papers.shchur2019 import cycle, geometry, steps
from ev_papers.shchur2019.panels import PANELS

__all__ = ["DECLARATIONS", "ORDER", "PANELS"]

ORDER = 0  # among the sources, in tables
DECLARATIONS = (
    *steps.DECLARATIONS,
    *cycle.DECLARATIONS,
    *geometry.DECLARATIONS,
)
