"""The figures of the source of config/published/ge_ni2005.csv."""

from __future__ import annotations

from ev_sim.verdicts.panel import PublishedPanel

PANELS: tuple[PublishedPanel, ...] = ()
