"""A quantity over two others as contour lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_sim.report.figures.drawing import TEXT_SIZE, TITLE_SIZE
from ev_sim.report.figures.figure import Figure, new_figure

WIDTH, HEIGHT = 4.6, 3.0  # [inch]


def contours(
    title: str,
    x: tuple[str, np.ndarray],
    y: tuple[str, np.ndarray],
    values: np.ndarray,
    levels: Sequence[float],
) -> Figure:
    """Lines of equal `values` (rows, columns), NaN where there are none; `x` and `y` are label and places of them."""
    figure = new_figure(WIDTH, HEIGHT)
    figure.subplots_adjust(left=0.13, right=0.97, bottom=0.15, top=0.92)
    axes = figure.add_subplot()
    lines = axes.contour(x[1], y[1], values, levels=levels, cmap="viridis", linewidths=1.0)
    axes.clabel(lines, fontsize=TEXT_SIZE - 1)
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_xlabel(x[0], fontsize=TEXT_SIZE)
    axes.set_ylabel(y[0], fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    axes.grid(True, color="0.88", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    return figure
