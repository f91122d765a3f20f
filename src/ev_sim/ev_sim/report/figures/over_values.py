"""Metrics over one or two parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_sim.report.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.report.figures.figure import Figure, new_figure

WIDTH, HEIGHT = 4.6, 2.5  # of a panel with its labels [inch]


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
