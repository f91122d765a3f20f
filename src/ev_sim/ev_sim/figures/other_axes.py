"""Figures over other abscissae than time: curves, maps and contour lines, paths seen from above, histograms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ev_sim.figures.drawing import (
    PANEL_HEIGHT,
    PANEL_WIDTH,
    STROKES,
    TEXT_SIZE,
    TITLE_SIZE,
    Axes,
    Curve,
    Figure,
    name_axes,
    new_figure,
)


def contours(
    title: str, x: tuple[str, np.ndarray], y: tuple[str, np.ndarray], values: np.ndarray, levels: Sequence[float]
) -> Figure:
    """Lines of equal `values` (rows, columns), NaN where there are none; `x` and `y` are label and places of them."""
    figure = new_figure(4.6, 3.0)
    figure.subplots_adjust(left=0.13, right=0.97, bottom=0.15, top=0.92)
    axes = figure.add_subplot()
    lines = axes.contour(x[1], y[1], values, levels=levels, cmap="viridis", linewidths=1.0)
    axes.clabel(lines, fontsize=TEXT_SIZE - 1)
    name_axes(axes, title, x[0], y[0])
    return figure


_WIDTH, _HEIGHT = 4.6, 2.5  # of a panel with its labels [inch]
_FINE, _BEYOND = "#CFE3F0", "#E8A27C"  # below and from the limit on; the number in the cell is the distance


def heat_maps(
    maps: Mapping[str, np.ndarray],
    columns: tuple[str, Sequence[str]],
    rows: tuple[str, Sequence[str]],
    quantity: str,
    limit: float,
) -> Figure:
    """A figure of maps, two abreast, of values (rows, columns) by their title; cells from the limit on stand out.

    `columns` and `rows` are label and ticks.
    """
    figure, panels = _panels(len(maps))
    for axes, (title, values) in zip(panels, maps.items(), strict=True):
        axes.pcolormesh((values >= limit).astype(float), cmap=_colours(), vmin=0.0, vmax=1.0, edgecolors="white")
        for row, column in np.ndindex(values.shape):
            axes.text(
                column + 0.5, row + 0.5, f"{values[row, column]:.1f}", ha="center", va="center", fontsize=TEXT_SIZE - 1
            )
        axes.set_xticks(np.arange(len(columns[1])) + 0.5, columns[1])
        axes.set_yticks(np.arange(len(rows[1])) + 0.5, rows[1])
        name_axes(axes, f"{title}: {quantity}", columns[0], rows[0], ticks=0.0, grid="")
        axes.spines[:].set_visible(False)
    return figure


def _colours():
    from matplotlib.colors import ListedColormap

    return ListedColormap([_FINE, _BEYOND])


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
    figure = new_figure(2 * _WIDTH, lines * _HEIGHT, layout="constrained")
    return figure, [figure.add_subplot(lines, 2, number + 1) for number in range(count)]


def _label(axes, title: str, xlabel: str, ylabel: str) -> None:
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_xlabel(xlabel, fontsize=TEXT_SIZE)
    axes.set_ylabel(ylabel, fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE)


_ACROSS = 9.2  # of the figure, and of the margins around what is drawn [inch]
_LEFT, _RIGHT, _BOTTOM, _ABOVE = 0.7, 0.15, 0.48, 0.32
_LOWEST, _HIGHEST = 1.3, 5.5  # of what is drawn [inch]
_ABREAST, _ROW = 6, 0.2  # entries abreast, and the height of a row [inch]
_MAGNIFIED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)  # times that a narrow course is drawn across


def plan_view(
    title: str, tracks: Sequence[Curve], cones: np.ndarray | None = None, hit: np.ndarray | None = None
) -> Figure:
    """A figure of tracks, y over x [m], along and across to the same scale.

    A course that would be too narrow to be seen is drawn larger across, and its title gives the factor. `cones` (n, 2)
    [m] are drawn as rings, filled where `hit` (n,) says so.
    """
    figure = new_figure(_ACROSS, _ACROSS)  # until it is known what is drawn
    axes = figure.add_subplot()
    for number, track in enumerate(tracks):
        colour, dashes = STROKES[number % len(STROKES)]
        axes.plot(track.time, track.values, color=colour, linestyle=dashes, linewidth=1.3, label=track.label or None)
    if cones is not None:
        hit = np.zeros(len(cones), bool) if hit is None else hit
        axes.plot(*cones[~hit].T, "o", mfc="none", mec="0.4", ms=4.0, label="cones")
        if hit.any():
            axes.plot(*cones[hit].T, "o", color="#D55E00", ms=5.0, label="cones hit")
    rows = -(-len(axes.get_legend_handles_labels()[1]) // _ABREAST)
    times = _arrange(figure, rows)
    across = f", across {times} times as large as along" if times > 1 else ""
    name_axes(axes, title + across, "x [m]", "y [m]")
    if rows:
        figure.legend(loc="upper center", ncols=_ABREAST, fontsize=TEXT_SIZE, frameon=False)
    return figure


def _arrange(figure: Figure, rows: int) -> int:
    """Size the figure for what is drawn below a legend of some rows; how many times larger it is across than along."""
    (axes,) = figure.axes
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    ratio = (high - low) / (right - left)
    width = _ACROSS - _LEFT - _RIGHT
    times = next((each for each in _MAGNIFIED if ratio * width * each >= _LOWEST), _MAGNIFIED[-1])
    height = min(ratio * width * times, _HIGHEST)
    above = _ABOVE + _ROW * rows
    total = height + _BOTTOM + above
    figure.set_size_inches(_ACROSS, total)
    figure.subplots_adjust(
        left=_LEFT / _ACROSS, right=1 - _RIGHT / _ACROSS, bottom=_BOTTOM / total, top=1 - above / total
    )  # fmt: skip
    axes.set_aspect(times, adjustable="datalim" if height == _HIGHEST else "box")
    return times


Histograms = tuple[str, Mapping[str, Mapping[str, Any]]]  # title, and histograms by label


def timing_sheet(timings: Mapping[str, Mapping[str, Any]]) -> Figure:
    """Period, lateness of the steps, and arrival of every input, a column for each run (`master/real_time.py`)."""
    return histogram_sheet(
        [
            (f"{name}: period", {"": timing["period"]}),
            (f"{name}: lateness of steps", {"": timing["lateness"]}),
            (f"{name}: arrival after the instant was due", timing["arrival"]),
        ]
        for name, timing in timings.items()
    )


def histogram_sheet(columns: Iterable[Sequence[Histograms]]) -> Figure:
    """Columns of panels of times, counted in bins (`master/real_time.py`)."""
    panels = list(columns)
    rows = max(map(len, panels))
    figure = new_figure(PANEL_WIDTH * len(panels), rows * PANEL_HEIGHT, layout="constrained")
    for column, parts in enumerate(panels):
        for row, (title, histograms) in enumerate(parts):
            axes = figure.add_subplot(rows, len(panels), row * len(panels) + column + 1)
            _draw(axes, title, histograms)
    return figure


def _draw(axes: Axes, title: str, histograms: Mapping[str, Mapping[str, Any]]) -> None:
    for number, (label, histogram) in enumerate(histograms.items()):
        edges, counts = histogram["edges"], histogram["counts"]
        colour, dashes = STROKES[number % len(STROKES)]
        ends = [edges[0] / 2, *edges, 2 * edges[-1]]
        axes.stairs(counts, [1e3 * end for end in ends], color=colour, linestyle=dashes, label=label or None)
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, None)
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE)
    axes.set_xlabel("time [ms]", fontsize=TEXT_SIZE)
    axes.set_ylabel("count", fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE)
    if len(histograms) > 1:
        axes.legend(fontsize=TEXT_SIZE, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05))
