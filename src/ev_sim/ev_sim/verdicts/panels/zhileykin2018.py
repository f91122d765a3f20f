"""The figures of the source of config/published/zhileykin2018.csv."""

from __future__ import annotations

from ev_sim.verdicts.panel import PublishedPanel

PANELS: tuple[PublishedPanel, ...] = ()
