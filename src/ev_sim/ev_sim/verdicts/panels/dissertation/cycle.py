"""Figures 2.8 to 2.13: the fitted slip curve, the cycles and the road."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_sim.profiles.profile_file import with_profile_from_file
from ev_sim.profiles.speed_profile import SpeedProfileParameters
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.figures.slip_curve import slip_curve_figure
from ev_sim.report.figures.urban_cycle import cycle_figure
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn, over_time
from ev_sim.verdicts.panels.dissertation.runs import CYCLES, driver_of, run_of

_CYCLES = "Speed over time of urban cycles"
_NO_DATA = "the source draws it from a catalogue, no data are in the text"


def _slip_curve(driven: ScenarioRuns) -> Figure:
    return slip_curve_figure(run_of(driven), driven.vehicle)


def _road(driven: ScenarioRuns) -> Figure:
    return cycle_figure(run_of(driven), driven.vehicle, driver_of(driven))


def _cycle(title: str, file: str) -> Callable[[], Panel]:
    def points() -> list[Curve]:
        cycle = with_profile_from_file(SpeedProfileParameters(file=file))
        return [Curve(np.array(cycle.time), 3.6 * np.array(cycle.speed))]

    return lambda: panel(title, "speed [km/h]", points)


PANELS = (
    PublishedPanel("2.8", "", "Fit of the slip curve", ("diss.fig2.8",), (CYCLES[1],), _slip_curve),
    cannot_be_drawn("2.9", "", _CYCLES, f"European Transient Cycle: {_NO_DATA}", "diss.fig2.9"),
    PublishedPanel(
        "2.10",
        "",
        _CYCLES,
        ("diss.fig2.10",),
        draw=over_time(_cycle("EPA New York City Cycle, the public data", "cycles/nycc.csv")),
    ),
    cannot_be_drawn("2.11", "", _CYCLES, f"modemIM Urban_Slow: {_NO_DATA}", "diss.fig2.11"),
    PublishedPanel(
        "2.12", "", _CYCLES, ("diss.fig2.12",), draw=over_time(_cycle("TRRL 1.1, table 2.4", "cycles/trrl_1_1.csv"))
    ),
    PublishedPanel("2.13", "", "Cycle and road", ("diss.fig2.13",), (CYCLES[1],), _road),
)
