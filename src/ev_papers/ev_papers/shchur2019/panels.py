"""The figures of Shchur (2019)."""

from __future__ import annotations

from ev_papers.shchur2019 import report_cycle as cycle
from ev_papers.shchur2019 import report_steps as steps
from ev_papers.shchur2019.cycle import CYCLE
from ev_papers.shchur2019.steps import STEPS
from ev_sim.figures.panels import Panel
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

_FIG_1, _FIG_4 = "Steps of the hand torque", "Driving cycle"


def _of_steps(letter: str, *ids: str) -> PublishedPanel:
    def panel(driven: ScenarioRuns) -> Panel:
        return steps.panels(driven.runs)[letter]

    named = tuple(f"shchur.fig1{letter}.{id}" for id in ids)
    return PublishedPanel("1", letter, _FIG_1, named, (STEPS,), over_time(panel, steps.SINCE_STEP, start=0.0))


def _of_cycle(quantity: str, *ids: str) -> PublishedPanel:
    def panel(driven: ScenarioRuns) -> Panel:
        return cycle.panels(driven.runs, driven.vehicle)[quantity]

    return PublishedPanel("4", quantity, _FIG_4, tuple(f"shchur.fig4.{id}" for id in ids), (CYCLE,), over_time(panel))


PANELS = (
    _of_steps("a", "1.steady", "1.overshoot", "1.settling", "2.steady", "2.overshoot", "2.settling", "damped"),
    _of_steps("b", "start", "minimum", "end"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the turn, no quantity over another one", "shchur.fig2"),
    cannot_be_drawn("3", "", "Schemes", "a scheme of the control, no quantity over another one", "shchur.fig3"),
    _of_cycle("V", "V1", "V2"),
    _of_cycle("M", "M.plateau", "M.acceleration"),
    _of_cycle("delta", "delta.left", "delta.right"),
    _of_cycle("dM", "dM.left", "dM.right"),
    _of_cycle("references", "references"),
    _of_cycle("drive_torques", "drive_torques"),
    _of_cycle("wheel_speeds", "wheel_speeds"),
    _of_cycle("dV", "dV"),
)
