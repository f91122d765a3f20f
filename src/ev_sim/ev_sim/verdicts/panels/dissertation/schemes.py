"""Figures that are schemes, block diagrams, photographs or screens."""

from __future__ import annotations

from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn

_ROWS = {
    "1": ("Block diagrams of the surveyed slip controls", range(14, 21)),
    "2": ("Schemes of car, wheel, body and control, screens of the model", (*range(1, 8), *range(14, 22))),
    "4": ("The test bench", range(1, 12)),
}
_WHY = "a scheme, a photograph or a screen, no quantity over another one"


def _scheme(row: str, figure: str) -> PublishedPanel:
    return cannot_be_drawn(figure, "", row, _WHY, f"diss.fig{figure}")


PANELS = tuple(_scheme(row, f"{chapter}.{number}") for chapter, (row, numbers) in _ROWS.items() for number in numbers)
