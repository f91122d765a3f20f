"""Efficiencies of methods over many roads beside the printed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ev_sim.report.figures.drawing import STROKES, TEXT_SIZE, TITLE_SIZE
from ev_sim.report.figures.figure import Figure, new_figure

_OURS, _PRINTED = STROKES[0][0], STROKES[1][0]


def efficiency_figure(
    points: Mapping[str, Mapping[int, Sequence[float]]], printed: Mapping[int, float], titles: Mapping[int, str]
) -> Figure:
    """One panel for each driver: the seeds as dots, their mean and the printed value, if any, as lines, by method."""
    figure = new_figure(3.6 * len(points), 3.0, layout="constrained")
    panels = figure.subplots(1, len(points), sharey=True, squeeze=False)[0]
    for axes, (driver, by_method) in zip(panels, points.items(), strict=True):
        for method, values in by_method.items():
            if values:
                axes.plot([method] * len(values), values, ".", color=_OURS, markersize=3, label="a seed")
                mean = sum(values) / len(values)
                axes.hlines(mean, method - 0.3, method + 0.3, color=_OURS, linewidth=1.6, label="mean of the seeds")
            ends = method - 0.4, method + 0.4
            if method in printed:
                line = {"color": _PRINTED, "linestyle": STROKES[1][1], "linewidth": 1.6}
                axes.hlines(printed[method], *ends, label="printed", **line)
        axes.set_title(f"driver {driver}", loc="left", fontsize=TITLE_SIZE)
        axes.set_xticks(list(by_method), [titles[method].replace(" ", "\n") for method in by_method])
        axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
        axes.set_ylim(0.4, 1.0)
        axes.grid(True, axis="y", color="0.88", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("wheel efficiency [1]", fontsize=TEXT_SIZE)
    handles, labels = panels[0].get_legend_handles_labels()
    entries = dict(zip(labels, handles, strict=True))
    figure.legend(entries.values(), entries, loc="outside upper center", ncols=3, fontsize=TEXT_SIZE, frameon=False)
    return figure
