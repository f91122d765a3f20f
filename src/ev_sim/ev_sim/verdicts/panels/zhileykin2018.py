"""The figures of Zhileykin & Eranosyan (2018)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ev_sim.report.figures.panels import Panel
from ev_sim.report.scenarios import zhileykin2018 as bend
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn, over_time
from ev_sim.verdicts.sources.zhileykin2018.inputs import BEND

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PATHS, _SHARES = "Paths", "Shares of the torque"


def _path(figure: str, title: str, *runs: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Figure:
        from ev_sim.report.figures.plan_view import plan_view

        return plan_view(title, [bend.track(driven.runs, name) for name in runs])

    return PublishedPanel(figure, "", _PATHS, (f"zhil.fig{figure}",), (BEND,), draw)


def _share(letter: str) -> PublishedPanel:
    def panel(driven: ScenarioRuns) -> Panel:
        return bend.panels(driven.runs)[letter]

    ends = (0.0, 0.5) if letter == "a" else (0.0, 1.0)
    return PublishedPanel("5", letter, _SHARES, (f"zhil.fig5{letter}",), (BEND,), over_time(panel, ends=ends))


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "zhil.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the driveline, no quantity over another one", "zhil.fig2"),
    _path("3", "Path of the rear-driven car", "rear_drive"),
    _path("4", "Path of the 4x4", "k1", "k05", "equality", "fixed_split"),
    *map(_share, "abc"),
)
