"""The figures of Tatar & Chudzik."""

from __future__ import annotations

from ev_sim.report.figures.panels import Panel
from ev_sim.report.scenarios import tatar_chudzik as report
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn, over_time
from ev_sim.verdicts.sources.tatar_chudzik.runs import RUNS

_ROWS = {
    "F_y with equal torques": (3, 6, 9),
    "F_x with equal torques": (4, 7, 10),
    "Wheel speeds with equal torques": (5, 8, 11),
    "F_y with corrected torques": (12, 13, 14),
}


def _panel(number: int, row: str) -> PublishedPanel:
    def panel(driven: ScenarioRuns) -> Panel:
        return report.panels(driven.runs, driven.vehicle)[number]

    wheels = ("FL", "FR", "RL", "RR") if number >= 12 else ()
    ids = tuple(f"tatar.fig{number}.{wheel}" for wheel in wheels) or (f"tatar.fig{number}",)
    shown = (*ids, "tatar.fig12_14.curves") if wheels else ids
    return PublishedPanel(str(number), "", row, shown, (RUNS,), over_time(panel))


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "tatar.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of inputs and outputs, no quantity over another one", "tatar.fig2"),
    *(_panel(number, row) for row, numbers in _ROWS.items() for number in numbers),
)
