"""The place of Zhileykin (2018) among the sources, what measures the numbers of published.csv, and the figures."""

from __future__ import annotations

from ev_papers.zhileykin2018 import measures
from ev_papers.zhileykin2018.grid import BY_LAW, REAR_DRIVE
from ev_papers.zhileykin2018.report import panels, track
from ev_sim.figures.other_axes import plan_view
from ev_sim.verdicts.check import measures_of
from ev_sim.verdicts.need import ScenarioNeed
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

ORDER = 4  # among the sources, in tables
MEASURES = measures_of(measures)
_BEND = (ScenarioNeed("zhileykin2018"),)


def _paths(figure: str, title: str, *names: str) -> PublishedPanel:
    return PublishedPanel(
        figure,
        "",
        "Paths",
        (f"zhil.fig{figure}",),
        _BEND,
        lambda driven: plan_view(title, [track(driven.runs, name) for name in names]),
    )


def _share(letter: str, most: float) -> PublishedPanel:
    draw = over_time(lambda driven: panels(driven.runs)[letter], ends=(0.0, most))
    return PublishedPanel("5", letter, "Shares of the drive torque", (f"zhil.fig5{letter}",), _BEND, draw)


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "zhil.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the driveline, no quantity over another one", "zhil.fig2"),
    _paths("3", "Path of the rear-driven car on ice", REAR_DRIVE),
    _paths("4", "Path of the 4x4 on ice", *BY_LAW),  # by each reading: the source names none
    _share("a", 0.5),
    _share("b", 1.0),
    _share("c", 1.0),
)
