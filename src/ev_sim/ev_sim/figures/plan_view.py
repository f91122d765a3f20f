"""Paths seen from above as a figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_sim.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.figures.figure import Figure, new_figure
from ev_sim.figures.panels import Curve

WIDTH = 9.2  # of the figure, and of the margins around what is drawn [inch]
LEFT, RIGHT, BOTTOM, ABOVE = 0.7, 0.15, 0.48, 0.32
LOWEST, HIGHEST = 1.3, 5.5  # of what is drawn [inch]
LEGEND_COLUMNS, LEGEND_ROW = 6, 0.2  # entries abreast, and the height of a row [inch]
MAGNIFIED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)  # times that a narrow course is drawn across


def plan_view(
    title: str, tracks: Sequence[Curve], cones: np.ndarray | None = None, hit: np.ndarray | None = None
) -> Figure:
    """A figure of tracks, y over x [m], along and across to the same scale.

    A course that would be too narrow to be seen is drawn larger across, and its title says how much. `cones` (n, 2)
    [m] are drawn as rings, filled where `hit` (n,) says so.
    """
    figure = new_figure(WIDTH, WIDTH)  # until it is known what is drawn
    axes = figure.add_subplot()
    for number, track in enumerate(tracks):
        colour, dashes = STROKES[number % len(STROKES)]
        axes.plot(track.time, track.values, color=colour, linestyle=dashes, linewidth=1.3, label=track.label or None)
    if cones is not None:
        hit = np.zeros(len(cones), bool) if hit is None else hit
        axes.plot(*cones[~hit].T, "o", mfc="none", mec="0.4", ms=4.0, label="cones")
        if hit.any():
            axes.plot(*cones[hit].T, "o", color="#D55E00", ms=5.0, label="cones hit")
    rows = -(-len(axes.get_legend_handles_labels()[1]) // LEGEND_COLUMNS)
    times = _arrange(figure, rows)
    across = f", across {times} times as large as along" if times > 1 else ""
    axes.set_title(title + across, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_xlabel("x [m]", fontsize=TEXT_SIZE)
    axes.set_ylabel("y [m]", fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    axes.grid(True, color="0.88", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if rows:
        figure.legend(loc="upper center", ncols=LEGEND_COLUMNS, fontsize=TEXT_SIZE, frameon=False)
    return figure


def _arrange(figure: Figure, rows: int) -> int:
    """Size the figure for what is drawn below a legend of some rows; how many times larger it is across than along."""
    (axes,) = figure.axes
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    ratio = (high - low) / (right - left)
    width = WIDTH - LEFT - RIGHT
    times = next((each for each in MAGNIFIED if ratio * width * each >= LOWEST), MAGNIFIED[-1])
    height = min(ratio * width * times, HIGHEST)
    above = ABOVE + LEGEND_ROW * rows
    total = height + BOTTOM + above
    figure.set_size_inches(WIDTH, total)
    figure.subplots_adjust(
        left=LEFT / WIDTH, right=1 - RIGHT / WIDTH, bottom=BOTTOM / total, top=1 - above / total
    )  # fmt: skip
    axes.set_aspect(times, adjustable="datalim" if height == HIGHEST else "box")
    return times
