"""How the ids of config/published/tatar_chudzik.csv are judged."""

from __future__ import annotations

from ev_sim.verdicts.declaration import Declaration

DECLARATIONS: tuple[Declaration, ...] = ()
