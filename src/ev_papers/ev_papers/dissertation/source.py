"""How what the source published (published.csv) is judged and drawn."""

from __future__ import annotations

from ev_papers.dissertation import bench, cycle, efficiencies, gains, regulation, surfaces, survey, vehicle
from ev_papers.dissertation.figures.panels import PANELS

__all__ = ["DECLARATIONS", "ORDER", "PANELS"]

ORDER = 3  # among the sources, in tables
DECLARATIONS = (
    *survey.DECLARATIONS,
    *vehicle.DECLARATIONS,
    *surfaces.DECLARATIONS,
    *cycle.DECLARATIONS,
    *regulation.DECLARATIONS,
    *efficiencies.DECLARATIONS,
    *gains.DECLARATIONS,
    *bench.DECLARATIONS,
)
