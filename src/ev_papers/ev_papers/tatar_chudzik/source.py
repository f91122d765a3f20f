"""How what the source published (published.csv) is judged and drawn."""

from __future__ import annotations

from ev_papers.tatar_chudzik import verdicts
from ev_papers.tatar_chudzik.panels import PANELS

__all__ = ["DECLARATIONS", "ORDER", "PANELS"]

ORDER = 2  # among the sources, in tables
DECLARATIONS = (*verdicts.DECLARATIONS,)
