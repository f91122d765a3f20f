"""The figures of Zhileykin & Eranosyan (2018): paths in the plane, and shares of the drive torque over time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.samples import channel, run_named
from ev_sim.run.recording.recording import Recording
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn, over_time

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BEND = ScenarioNeed("zhileykin2018", runs=("rear_drive", "k05", "k1"))
_4X4 = ("k05", "k1")  # factors of the law, which the source does not give
_FRONT, _REAR = ("front_left", "front_right"), ("rear_left", "rear_right")


def _paths(title: str, names: tuple[str, ...]) -> Callable[[ScenarioRuns], Figure]:
    def draw(driven: ScenarioRuns) -> Figure:
        from ev_sim.report.figures.plan_view import plan_view

        runs = {name: run_named(driven.runs, name) for name in names}
        return plan_view(title, [Curve(channel(run, "pose.x"), channel(run, "pose.y"), n) for n, run in runs.items()])

    return draw


def _torque(run: Recording, wheels: tuple[str, ...]) -> np.ndarray:
    return sum(channel(run, f"torque_request.drive.{wheel}") for wheel in wheels)


def _share(title: str, part: tuple[str, ...], whole: tuple[str, ...]) -> Callable[[ScenarioRuns], Panel]:
    """The torque that the law asks of some wheels, over that of more of them."""

    def curves(driven: ScenarioRuns) -> list[Curve]:
        runs = {name: run_named(driven.runs, name) for name in _4X4}
        return [Curve(run.time, _torque(run, part) / _torque(run, whole), name) for name, run in runs.items()]

    return lambda driven: panel(title, "share [1]", lambda: curves(driven))


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "zhil.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the driveline, no quantity over another one", "zhil.fig2"),
    PublishedPanel(
        "3", "", "Paths", ("zhil.fig3",), (_BEND,), _paths("Path of the rear-driven car on ice", ("rear_drive",))
    ),
    PublishedPanel("4", "", "Paths", ("zhil.fig4",), (_BEND,), _paths("Path of the 4x4 on ice", _4X4)),
    *(
        PublishedPanel(
            "5", letter, "Shares of the drive torque", (f"zhil.fig5{letter}",), (_BEND,), over_time(share, ends=ends)
        )
        for letter, share, ends in (
            ("a", _share("a  Front axle, h_n", _FRONT, _FRONT + _REAR), (0.0, 0.5)),
            ("b", _share("b  Rear left, h_2", _REAR[:1], _REAR), (0.0, 1.0)),
            ("c", _share("c  Rear right, h_4", _REAR[1:], _REAR), (0.0, 1.0)),
        )
    ),
)
