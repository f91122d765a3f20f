"""The urban cycle over time with what lies under the wheels, counterpart of the dissertation's figure 2.13."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.urban_sheets import (
    MODE_COLOURS,
    SURFACE_COLOURS,
    TIME,
    WIDTH,
    draw_strip,
    left_and_right,
    stretches,
)
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE, thinned
from ev_sim.figures.figure import DPI, Axes, Figure, new_figure
from ev_sim.measures import motion
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.surfaces_under import surfaces_under
from ev_sim.recording.recording import Recording


def cycle_figure(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Figure 2.13: the cycle over time, what lies under the wheels, and the windows."""
    figure = new_figure(WIDTH, 4.2)
    rows = figure.subplots(4, 1, sharex=True, height_ratios=(8, 1, 1, 1))
    figure.subplots_adjust(left=0.085, right=0.985, bottom=0.2, top=0.94, hspace=0.16)
    speed, *strips = rows
    _draw_speed(speed, run, driver)
    shown: dict[str, str] = {}
    for axes, wheel in zip(strips[:2], left_and_right(vehicle), strict=True):
        _strip(axes, run, lambda wheel=wheel: surfaces_under(run, vehicle, wheel), SURFACE_COLOURS, wheel, shown)
    _strip(strips[2], run, lambda: cycle.modes_over_time(run, driver), MODE_COLOURS, "window", shown)
    for axes in rows:
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    strips[2].set_xlabel(TIME, fontsize=TEXT_SIZE)
    strips[2].set_xlim(run.time[0], run.time[-1])
    from matplotlib.patches import Patch

    patches = [Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=name) for name, colour in shown.items()]
    if patches:
        figure.legend(handles=patches, loc="lower center", ncols=len(patches), fontsize=TEXT_SIZE, frameon=False)
    return figure


def _draw_speed(axes: Axes, run: Recording, driver: Mapping[str, Any]) -> None:
    curves = (
        ("driven", STROKES[1][0], 0.8, lambda: motion.path_speed(run)),
        ("cycle", STROKES[0][0], 1.2, lambda: cycle.wanted_speed(run, driver)),
    )
    missing = []
    for label, colour, width, values in curves:
        try:
            axes.plot(*thinned(run.time, values(), int(WIDTH * DPI)), color=colour, linewidth=width, label=label)
        except NotMeasured as why:
            missing.append(f"{label} not measured: {why}")
    if missing:
        axes.text(0.5, 0.5, "\n".join(missing), transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE, color="0.4")
    axes.set_title("Urban cycle and what lies under the wheels", loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_ylabel("speed [m/s]", fontsize=TEXT_SIZE)
    axes.set_ylim(bottom=0.0)
    axes.grid(True, color="0.88", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="upper right", bbox_to_anchor=(1.0, 1.1), ncols=2, fontsize=TEXT_SIZE, frameon=False)


def _strip(
    axes: Axes,
    run: Recording,
    names: Callable[[], np.ndarray],
    colours: Mapping[str, str],
    label: str,
    shown: dict[str, str],
) -> None:
    """Draw a strip and note which colours it shows, by the words of the legend."""
    try:
        pieces = stretches(run.time, names())
    except NotMeasured as why:
        pieces = []
        axes.text(0.5, 0.3, f"not measured: {why}", transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE)
    draw_strip(axes, pieces, colours, label.replace("_", " "))
    present = {piece for _, _, piece in pieces}
    shown.update({name.replace("_", " "): colour for name, colour in colours.items() if name in present})
