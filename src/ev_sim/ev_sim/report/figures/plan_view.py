"""Paths seen from above as a figure. Imports matplotlib: import this module only where something is drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ev_sim.report.figures.drawing import DPI, STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.report.figures.panels import Curve

WIDTH, HEIGHT = 9.2, 3.2  # [inch]


def plan_view(
    title: str, tracks: Sequence[Curve], cones: np.ndarray | None = None, hit: np.ndarray | None = None
) -> Figure:
    """A figure of tracks, y over x [m], to the scale that fits (across and along differ).

    `cones` (n, 2) [m] are drawn as rings, filled where `hit` (n,) says so.
    """
    figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI)
    figure.subplots_adjust(left=0.08, right=0.985, bottom=0.15, top=0.9)
    axes = figure.add_subplot()
    for number, track in enumerate(tracks):
        colour, dashes = STROKES[number % len(STROKES)]
        axes.plot(track.time, track.values, color=colour, linestyle=dashes, linewidth=1.3, label=track.label or None)
    if cones is not None:
        hit = np.zeros(len(cones), bool) if hit is None else hit
        axes.plot(*cones[~hit].T, "o", mfc="none", mec="0.4", ms=4.0, label="cones")
        if hit.any():
            axes.plot(*cones[hit].T, "o", color="#D55E00", ms=5.0, label="cones hit")
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_xlabel("x [m]", fontsize=TEXT_SIZE)
    axes.set_ylabel("y [m]", fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    axes.grid(True, color="0.88", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="best", fontsize=TEXT_SIZE, frameon=False)
    return figure
