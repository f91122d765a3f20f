"""Histograms of how well real time was kept."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ev_sim.figures.drawing import PANEL_HEIGHT, PANEL_WIDTH, STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.figures.figure import Axes, Figure, new_figure

Panel = tuple[str, Mapping[str, Mapping[str, Any]]]  # title, and histograms by label


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


def histogram_sheet(columns: Iterable[Sequence[Panel]]) -> Figure:
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
