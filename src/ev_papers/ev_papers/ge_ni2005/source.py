"""How what the source published (published.csv) is judged and drawn."""

from __future__ import annotations

from ev_papers.ge_ni2005 import claims, steady
from ev_papers.ge_ni2005.panels import PANELS

__all__ = ["DECLARATIONS", "ORDER", "PANELS"]

ORDER = 1  # among the sources, in tables
DECLARATIONS = (
    *steady.DECLARATIONS,
    *claims.DECLARATIONS,
)
