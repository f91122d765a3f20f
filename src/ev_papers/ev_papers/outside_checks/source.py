"""Claims of papers on torque vectoring, judged on our cars as far as their abstracts go.

The texts could not be read. docs/outside_checks.md has what each abstract states and leaves open.

A source has its place ORDER, its PANELS, and in MEASURES the functions that published.csv names.
"""

from __future__ import annotations

from ev_papers.outside_checks import measures
from ev_study.verdicts.measure import measures_of

ORDER = 5  # among the sources, in tables
MEASURES = measures_of(measures)
PANELS = ()  # no figure could be read
