"""The place of Shchur (2019) among the sources, what measures the numbers of published.csv, and the figures."""

from __future__ import annotations

from ev_papers.shchur2019 import measures, report_cycle, report_steps
from ev_sim.verdicts.check import measures_of
from ev_sim.verdicts.need import ScenarioNeed
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

ORDER = 0  # among the sources, in tables
MEASURES = measures_of(measures)


def _of_steps(letter: str, *ids: str) -> PublishedPanel:
    draw = over_time(lambda driven: report_steps.panels(driven.runs)[letter], report_steps.SINCE_STEP, start=0.0)
    named = tuple(f"shchur.fig1{letter}.{id}" for id in ids)
    return PublishedPanel("1", letter, "Steps of the hand torque", named, (ScenarioNeed("shchur2019_steps"),), draw)


def _of_cycle(quantity: str, *ids: str) -> PublishedPanel:
    draw = over_time(lambda driven: report_cycle.panels(driven.runs, driven.vehicle)[quantity])
    named = tuple(f"shchur.fig4.{id}" for id in ids)
    return PublishedPanel("4", quantity, "Driving cycle", named, (ScenarioNeed("shchur2019"),), draw)


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
