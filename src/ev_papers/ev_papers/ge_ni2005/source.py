"""The place of Ge & Ni (2005) among the sources, what measures the numbers of published.csv, and the figures.

Figure 3 is drawn with the law, in each reading of it, 4 with equal torques; 3 s with u held.
"""

from __future__ import annotations

from ev_papers.ge_ni2005 import measures, report
from ev_papers.ge_ni2005.measures import BASELINE
from ev_sim.figures.drawing import Figure, sheet
from ev_sim.verdicts.check import measures_of
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panels_page import WIDTH, PublishedPanel, cannot_be_drawn

ORDER = 1  # among the sources, in tables
MEASURES = measures_of(measures)

_RUNS = {"3": report.READINGS, "4": (BASELINE,)}
_TITLES = {
    "a": "Sideslip angle",
    "b": "Radius of the path",
    "c": "Centripetal acceleration",
    "d": "Yaw rate w and lateral speed v",
    "e": "Slips of the driven wheels",
    "f": "Speeds of the driven wheels",
}
_ENDS = {"b": (0.0, 70.0), "c": (0.0, 0.6)}  # of the ordinate, which the scan has kept
_IDS = {
    "4b": ("ge.fig4b.axis", "ge.eq.radius"),
    "4c": ("ge.fig4c.axis", "ge.eq.centripetal"),
    "3f": ("ge.fig3f_4f",),
    "4f": ("ge.fig3f_4f", "ge.eq.speeds"),
}


def _panel(figure: str, letter: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Figure:
        shown = report.panels(driven.runs, driven.vehicle, _RUNS[figure])[letter]
        drawn = sheet(shown, "time [s]", columns=1, panel_width=WIDTH)
        for axes in drawn.axes if letter in _ENDS else ():
            axes.set_ylim(*_ENDS[letter])
        return drawn

    needs = (ScenarioNeed("ge_ni2005", runs=(BASELINE, *report.READINGS)),)
    ids = _IDS.get(figure + letter, (f"ge.fig{figure}{letter}",))
    return PublishedPanel(figure, letter, _TITLES[letter], ids, needs, draw)


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the model, no quantity over another one", "ge.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the law, no quantity over another one", "ge.fig2"),
    *(_panel(figure, letter) for letter in _TITLES for figure in _RUNS),
)
