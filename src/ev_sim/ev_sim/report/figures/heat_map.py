"""Values over two quantities as coloured cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ev_sim.report.figures.drawing import TEXT_SIZE, TITLE_SIZE
from ev_sim.report.figures.figure import Figure, new_figure

WIDTH, HEIGHT = 4.6, 2.5  # of a map with its labels [inch]
FINE, BEYOND = "#CFE3F0", "#E8A27C"  # below and from the limit on; the number in the cell says how far


@dataclass(frozen=True, slots=True, eq=False)
class HeatMap:
    """Values (rows, columns) under a title."""

    title: str
    values: np.ndarray


def heat_maps(
    maps: Sequence[HeatMap],
    columns: tuple[str, Sequence[str]],
    rows: tuple[str, Sequence[str]],
    quantity: str,
    limit: float,
) -> Figure:
    """A figure of maps, two abreast, with label and ticks of columns and rows; cells from the limit on stand out."""
    lines = -(-len(maps) // 2)
    figure = new_figure(2 * WIDTH, lines * HEIGHT, layout="constrained")
    for number, heat_map in enumerate(maps):
        axes = figure.add_subplot(lines, 2, number + 1)
        values = heat_map.values
        axes.pcolormesh((values >= limit).astype(float), cmap=_colours(), vmin=0.0, vmax=1.0, edgecolors="white")
        for row, column in np.ndindex(values.shape):
            axes.text(
                column + 0.5, row + 0.5, f"{values[row, column]:.1f}", ha="center", va="center", fontsize=TEXT_SIZE - 1
            )
        axes.set_title(f"{heat_map.title}: {quantity}", loc="left", fontsize=TITLE_SIZE, pad=3)
        axes.set_xticks(np.arange(len(columns[1])) + 0.5, columns[1])
        axes.set_yticks(np.arange(len(rows[1])) + 0.5, rows[1])
        axes.set_xlabel(columns[0], fontsize=TEXT_SIZE)
        axes.set_ylabel(rows[0], fontsize=TEXT_SIZE)
        axes.tick_params(labelsize=TEXT_SIZE, length=0.0)
        axes.spines[:].set_visible(False)
    return figure


def _colours():
    from matplotlib.colors import ListedColormap

    return ListedColormap([FINE, BEYOND])
