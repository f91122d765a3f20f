"""The dissertation as a source: measures of the numbers of published.csv, and figures."""

from __future__ import annotations

from ev_papers.dissertation import (
    judged_bench,
    judged_car,
    judged_claims,
    judged_cycle,
    judged_methods,
)
from ev_papers.dissertation.figures.panels import PANELS
from ev_study.verdicts.measure import measures_of

__all__ = ["MEASURES", "ORDER", "PANELS"]

ORDER = 3  # among the sources, in tables
MEASURES = measures_of(judged_bench, judged_car, judged_claims, judged_cycle, judged_methods)
