"""The figures of Ge & Ni (2005)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ev_sim.report.scenarios import ge_ni2005 as report
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn
from ev_sim.verdicts.sources.ge_ni2005.runs import BASELINE, COMPARED, READINGS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ROWS = {
    "a": "Sideslip angle",
    "b": "Radius of the path",
    "c": "Centripetal acceleration",
    "d": "Yaw rate and lateral speed",
    "e": "Slips of the driven wheels",
    "f": "Speeds of the driven wheels",
}
_FIGURES = {"3": READINGS, "4": (BASELINE,)}
_IDS = {"4b": ("ge.fig4b.axis",), "4c": ("ge.fig4c.axis",), "3f": ("ge.fig3f_4f",), "4f": ("ge.fig3f_4f",)}


def _panel(figure: str, letter: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Figure:
        from ev_sim.report.figures.drawing import sheet

        shown = report.panels(driven.runs, driven.vehicle, _FIGURES[figure])[letter]
        return sheet(shown, "time [s]", columns=1)

    ids = _IDS.get(figure + letter, (f"ge.fig{figure}{letter}",))
    return PublishedPanel(figure, letter, _ROWS[letter], ids, (COMPARED,), draw)


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the car, no quantity over another one", "ge.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the law, no quantity over another one", "ge.fig2"),
    *(_panel(figure, letter) for letter in _ROWS for figure in _FIGURES),
)
