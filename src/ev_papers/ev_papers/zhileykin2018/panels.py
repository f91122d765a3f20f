"""The figures of Zhileykin & Eranosyan (2018): paths in the plane, and shares of the drive torque over time."""

from __future__ import annotations

from collections.abc import Callable

from ev_papers.zhileykin2018.grid import REAR_DRIVE
from ev_papers.zhileykin2018.paper import BEND
from ev_papers.zhileykin2018.report import panels, track
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Panel
from ev_sim.figures.plan_view import plan_view
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

_4X4 = ("k05", "k1", "equality")  # factors of the law, and eq 4 as an equality: the source names neither


def _paths(title: str, names: tuple[str, ...]) -> Callable[[ScenarioRuns], Figure]:
    def draw(driven: ScenarioRuns) -> Figure:
        return plan_view(title, [track(driven.runs, name) for name in names])

    return draw


def _share(letter: str) -> Callable[[ScenarioRuns], Panel]:
    return lambda driven: panels(driven.runs)[letter]


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "zhil.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the driveline, no quantity over another one", "zhil.fig2"),
    PublishedPanel(
        "3", "", "Paths", ("zhil.fig3",), (BEND,), _paths("Path of the rear-driven car on ice", (REAR_DRIVE,))
    ),
    PublishedPanel("4", "", "Paths", ("zhil.fig4",), (BEND,), _paths("Path of the 4x4 on ice", _4X4)),
    *(
        PublishedPanel(
            "5",
            letter,
            "Shares of the drive torque",
            (f"zhil.fig5{letter}",),
            (BEND,),
            over_time(_share(letter), ends=ends),
        )
        for letter, ends in (("a", (0.0, 0.5)), ("b", (0.0, 1.0)), ("c", (0.0, 1.0)))
    ),
)
