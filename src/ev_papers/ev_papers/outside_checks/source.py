"""Claims of papers on torque vectoring, judged on our cars as far as their abstracts say enough.

The texts could not be read. docs/outside_checks.md has what each abstract states and leaves open.

A source has its place ORDER, the functions MEASURES that measure the numbers of published.csv, and its PANELS.
"""

from __future__ import annotations

from ev_papers.outside_checks import measures
from ev_study.verdicts.measure import measures_of

ORDER = 5  # among the sources, in tables
MEASURES = measures_of(measures)
PANELS = ()  # no figure could be read
