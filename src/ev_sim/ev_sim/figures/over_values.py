"""A quantity over one or two others: curves, contour lines, coloured cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ev_sim.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.figures.figure import Figure, new_figure


def contours(
    title: str, x: tuple[str, np.ndarray], y: tuple[str, np.ndarray], values: np.ndarray, levels: Sequence[float]
) -> Figure:
    """Lines of equal `values` (rows, columns), NaN where there are none; `x` and `y` are label and places of them."""
    figure = new_figure(4.6, 3.0)
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


WIDTH, HEIGHT = 4.6, 2.5  # of a panel with its labels [inch]
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


def lines_with_bands(xlabel: str, x: np.ndarray, metrics: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """For each metric, under its label, the mean over the seeds at each x (n,) and a band from least to largest.

    The values of a metric are (n, seeds).
    """
    figure, panels = _panels(len(metrics))
    for axes, (label, values) in zip(panels, metrics, strict=True):
        axes.plot(x, values.mean(axis=1), color=STROKES[0][0], marker=".")
        axes.fill_between(x, values.min(axis=1), values.max(axis=1), color=STROKES[0][0], alpha=0.2, linewidth=0.0)
        axes.ticklabel_format(useOffset=False)
        _label(axes, label, xlabel, label)
    return figure


def maps(xlabel: str, x: np.ndarray, ylabel: str, y: np.ndarray, metrics: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """For each metric, under its label, its values (rows at y, columns at x) as colours."""
    figure, panels = _panels(len(metrics))
    for axes, (label, values) in zip(panels, metrics, strict=True):
        shown = axes.pcolormesh(values, cmap="viridis")
        axes.set_xticks(np.arange(len(x)) + 0.5, [f"{value:g}" for value in x])
        axes.set_yticks(np.arange(len(y)) + 0.5, [f"{value:g}" for value in y])
        figure.colorbar(shown, ax=axes).ax.tick_params(labelsize=TEXT_SIZE)
        _label(axes, label, xlabel, ylabel)
    return figure


def _panels(count: int):
    lines = -(-count // 2)
    figure = new_figure(2 * WIDTH, lines * HEIGHT, layout="constrained")
    return figure, [figure.add_subplot(lines, 2, number + 1) for number in range(count)]


def _label(axes, title: str, xlabel: str, ylabel: str) -> None:
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_xlabel(xlabel, fontsize=TEXT_SIZE)
    axes.set_ylabel(ylabel, fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE)
