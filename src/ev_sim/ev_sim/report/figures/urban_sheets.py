"""Sheets over a whole urban cycle, left and right wheels side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.cycle_bands import shade_traction, stretches
from ev_sim.report.figures.drawing import sheet
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.metric import NotMeasured
from ev_sim.report.quantities import traction_windows as cycle
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording

WIDTH, NARROW = 9.2, 6.2  # of a panel alone, and of one beside another [inch]
TIME = "time [s]"


def thin_sheet(panels: list[Panel], columns: int = 1) -> Figure:
    """A sheet whose curves are thin enough for the pulses of a whole cycle."""
    figure = sheet(panels, TIME, columns=columns, panel_width=WIDTH if columns == 1 else NARROW)
    for line in (line for axes in figure.axes for line in axes.lines):
        line.set_linewidth(0.7)
    return figure


def sheet_over_cycle(panels: list[Panel], run: Recording, driver: Mapping[str, Any], columns: int = 1) -> Figure:
    """The same with the traction windows behind the curves."""
    figure = thin_sheet(panels, columns)
    try:
        shade_traction(figure, stretches(run.time, cycle.modes_over_time(run, driver)))
    except NotMeasured:
        return figure  # nothing to shade: the panels stand for themselves
    return figure


def left_and_right(vehicle: Vehicle) -> tuple[str, ...]:
    """The first two driven wheels; the front ones where fewer are driven."""
    return vehicle.driven_wheels[:2] if len(vehicle.driven_wheels) > 1 else ("front_left", "front_right")


def each_side(run: Recording, vehicle: Vehicle, title: str, ylabel: str, quantity: str) -> list[Panel]:
    """A panel for each side: pulses would hide each other."""
    return [
        panel(
            f"{title}, {wheel.replace('_', ' ')}",
            ylabel,
            lambda wheel=wheel: [Curve(run.time, channel(run, f"{quantity}.{wheel}"))],
        )
        for wheel in left_and_right(vehicle)
    ]


def both_sides(run: Recording, vehicle: Vehicle, quantity: str) -> list[Curve]:
    """A quantity of the wheels of both sides, in one panel."""
    return [
        Curve(run.time, channel(run, f"{quantity}.{wheel}"), wheel.replace("_", " "))
        for wheel in left_and_right(vehicle)
    ]
