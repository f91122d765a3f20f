"""Sheets over a whole urban cycle, left and right wheels side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.figures.drawing import sheet
from ev_sim.figures.figure import Axes, Figure
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel
from ev_sim.profiles.cycle_windows import MODES, TRACTION
from ev_sim.recording.recording import Recording

# The surfaces that are mixed most often, snow and wet asphalt, differ in lightness, so they do in print.
SURFACE_COLOURS = {
    "dry_asphalt": "#1A1A1A",
    "wet_asphalt_1": "#5B6770",
    "wet_asphalt_2": "#8A959C",
    "packed_snow_1": "#CFE8F7",
    "packed_snow_2": "#E6D9F0",
    "ice": "#7BD3EA",
    "dry_asphalt_burckhardt": "#403830",
}
MODE_COLOURS = dict(zip(MODES, ("#F2F2F2", "#F4B183", "#A9D18E"), strict=True))
_SHADE = "#FBF1E8"  # behind curves: that of traction, hardly visible


def stretches(time: np.ndarray, names: np.ndarray) -> list[tuple[float, float, str]]:
    """Start and end [s] of each stretch with one name, of names (n,) str over time (n,) [s]."""
    changes = np.flatnonzero(names[1:] != names[:-1]) + 1
    edges = [0, *changes.tolist(), len(names) - 1]
    return [(float(time[a]), float(time[b]), str(names[a])) for a, b in pairwise(edges)]


def draw_strip(axes: Axes, pieces: Sequence[tuple[float, float, str]], colours: Mapping[str, str], name: str) -> None:
    """A strip of colours over time, its name in place of an ordinate."""
    axes.broken_barh(
        [(start, end - start) for start, end, _ in pieces],
        (0.0, 1.0),
        facecolors=[colours[piece] for _, _, piece in pieces],
        linewidth=0.0,
    )
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_ylabel(name, rotation="horizontal", ha="right", va="center", fontsize=8.0)


def shade_traction(figure: Figure, pieces: Sequence[tuple[float, float, str]]) -> None:
    """A faint ground behind the traction windows in all axes of a figure over time."""
    for axes in figure.axes:
        limits = axes.get_xlim()
        for start, end, mode in pieces:
            if mode == MODES[TRACTION]:
                axes.axvspan(start, end, facecolor=_SHADE, edgecolor="none", zorder=0)
        axes.set_xlim(limits)


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
