"""Figures of the dissertation of which only captions are left."""

from __future__ import annotations

from ev_sim.verdicts.declaration import Declaration, no_verdict, not_judgeable
from ev_sim.verdicts.published import published

_DRAWN = (
    "curve not in the text; scripts/run.sh figures draws it for each method, with driver pulse, and those of chapter 5 "
    "on the bench"
)
_REASONS = {
    "diss.fig1.13": "maker's curves are not in the text",
    "diss.fig1.22": "maker's curves, voltages and efficiencies are not in the text; losses and winding are assumed",
    "diss.fig2.9": "no data in the text; any speed profile from CSV can be driven",
    "diss.fig2.10": "no data in the text; config/cycles/nycc.csv is the public cycle of this name",
    "diss.fig2.11": "no data in the text; any speed profile from CSV can be driven",
    "diss.fig2.13": "seed and lengths of the segments are not given; drawn for seed 1",
}
_SCHEMES = ("diss.fig1.1", "diss.fig2.", "diss.fig4.")  # block diagrams, schemes, photographs, screens


def _judged_elsewhere(id: str) -> bool:
    return published("dissertation")[id].kind != "lost" or id == "diss.bench.timing"


def _declared(id: str) -> Declaration:
    if id in _REASONS:
        return not_judgeable(id, _REASONS[id])
    if id.startswith(_SCHEMES):
        return no_verdict(id, "a scheme, a photograph or a screen, of which the text has the equations and data")
    is_efficiency = "efficiency" in published("dissertation")[id].quantity
    return not_judgeable(id, _DRAWN + ("; it ends at eq 2.37 or 2.38 of the road with seed 1" if is_efficiency else ""))


DECLARATIONS: tuple[Declaration, ...] = tuple(
    _declared(id) for id in published("dissertation") if not _judged_elsewhere(id)
)
