"""Panels that show no curve over time: maps, contour lines, paths from above, bands, histograms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_stack.figures.panels import Axes, Curve, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import HUES, stroke

_SHAPE = 0.62  # of a map: height over width
# below and from the limit on; the number in the cell is the distance
_FINE, _BEYOND = "#CFE3F0", "#E8A27C"
_LOWEST, _HIGHEST = 0.19, 0.6  # of a plan view: height over width
# times that a narrow course is drawn across
_MAGNIFIED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


def contours(
    title: str,
    x: tuple[str, np.ndarray],
    y: tuple[str, np.ndarray],
    values: np.ndarray,
    levels: Sequence[float],
) -> Panel:
    """Lines of equal `values` (rows, columns), NaN where there are none.

    `x` and `y` are the labels of the axes and the places of columns and rows.
    """

    def lines(axes: Axes) -> None:
        axes.clabel(axes.contour(x[1], y[1], values, levels=levels, linewidths=0.8))

    return Panel(title, y[0], ground=lines, xlabel=x[0], shape=_SHAPE)


def number_map(
    title: str,
    columns: tuple[str, Sequence[str]],
    rows: tuple[str, Sequence[str]],
    values: np.ndarray,
    limit: float,
) -> Panel:
    """Values (rows, columns) as numbers in cells; those from the limit on stand out."""

    def cells(axes: Axes) -> None:
        from matplotlib.colors import ListedColormap

        colours = ListedColormap([_FINE, _BEYOND])
        axes.pcolormesh(
            (values >= limit).astype(float), cmap=colours, vmin=0.0, vmax=1.0, edgecolors="white"
        )
        for row, column in np.ndindex(values.shape):
            number = f"{values[row, column]:.1f}"
            axes.text(column + 0.5, row + 0.5, number, ha="center", va="center", fontsize="small")
        axes.set_xticks(np.arange(len(columns[1])) + 0.5, columns[1])
        axes.set_yticks(np.arange(len(rows[1])) + 0.5, rows[1])
        _bare(axes)

    return Panel(title, rows[0], ground=cells, xlabel=columns[0], shape=_SHAPE)


def colour_map(
    title: str, x: tuple[str, np.ndarray], y: tuple[str, np.ndarray], unit: str, values: np.ndarray
) -> Panel:
    """Values (rows at y, columns at x) as colours of equal cells, with their colour bar.

    `x` and `y` are label and places.
    """

    def cells(axes: Axes) -> None:
        shown = axes.pcolormesh(values)
        for axis, places, most in ((axes.xaxis, x[1], 24), (axes.yaxis, y[1], 48)):
            names = _apart(places)
            # letters that have room beside or above each other
            every = -(-len(names) * max(map(len, names)) // most)
            axis.set_ticks((np.arange(len(names)) + 0.5)[::every], names[::every])
        axes.figure.colorbar(shown, ax=axes, label=f"[{unit}]")
        _bare(axes)

    return Panel(title, y[0], ground=cells, xlabel=x[0], shape=_SHAPE)


def _apart(places: np.ndarray) -> list[str]:
    """Numbers as texts, with as many digits as tell them apart, three at least."""
    for digits in range(3, 18):
        names = [f"{place:.{digits}g}" for place in places]
        # Equal places have equal names however many digits there are.
        if len(set(names)) == len(np.unique(places)):
            break
    return names


def _bare(axes: Axes) -> None:
    axes.grid(False)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0.0)


def mean_of_seeds(values: np.ndarray) -> np.ndarray:
    """The mean along the last axis of those that are no NaN; NaN where none is."""
    known = ~np.isnan(values)
    # np.nanmean warns where all are NaN, which is an ordinary cell here.
    count = known.sum(axis=-1)
    return np.divide(
        np.where(known, values, 0.0).sum(axis=-1),
        count,
        out=np.full(count.shape, np.nan),
        where=count > 0,
    )


def band(title: str, x: tuple[str, np.ndarray], quantity: str, values: np.ndarray) -> Panel:
    """Mean over the seeds at each x (n,), in a band from least to largest; values are (n, seeds).

    In the order of x, whatever that of the values is; NaN is of a seed that has none.
    """
    order = np.argsort(x[1], kind="stable")
    places, sorted_values = x[1][order], values[order]

    def lines(axes: Axes) -> None:
        seeds = values.shape[1]
        label = "mean of the seeds" if seeds > 1 else None
        axes.plot(places, mean_of_seeds(sorted_values), color=HUES[0], marker=".", label=label)
        if seeds > 1:
            # fmin and fmax pass over NaN, min and max do not.
            ends = np.fmin.reduce(sorted_values, axis=1), np.fmax.reduce(sorted_values, axis=1)
            axes.fill_between(
                places, *ends, color=HUES[0], alpha=0.2, linewidth=0.0, label="all seeds"
            )

    return Panel(title, quantity, ground=lines, xlabel=x[0])


def plan_view(
    title: str,
    tracks: Sequence[Curve],
    cones: np.ndarray | None = None,
    hit: np.ndarray | None = None,
) -> Sheet:
    """Tracks, y over x [m], along and across to the same scale.

    A course that would be too narrow to be seen is drawn larger across, and its title gives the
    factor. `cones` (n, 2) [m] are drawn as rings, filled where `hit` (n,) is true.
    """
    places = [np.column_stack((track.time, track.values)) for track in tracks]
    places = np.concatenate([*places, *([] if cones is None else [cones])])
    along, across = np.ptp(places, axis=0) if len(places) else (1.0, 1.0)
    # A car that stands or drives straight has no extent on one axis.
    ratio = max(across, 1e-6) / max(along, 1e-6)
    times = next((each for each in _MAGNIFIED if ratio * each >= _LOWEST), _MAGNIFIED[-1])

    def ground(axes: Axes) -> None:
        # The limits give way, not the box: the panel keeps its size among the others.
        axes.set_aspect(times, adjustable="datalim")
        if cones is None:
            return
        down = np.zeros(len(cones), bool) if hit is None else hit
        axes.plot(*cones[~down].T, "o", mfc="none", mec="0.4", label="cones")
        if down.any():
            axes.plot(*cones[down].T, "o", color=HUES[1], label="cones hit")

    larger = f", across {times} times as large as along" if times > 1 else ""
    shape = min(max(ratio * times, _LOWEST), _HIGHEST)
    return Sheet(
        [Panel(title + larger, "y [m]", tracks, ground=ground, xlabel="x [m]", shape=shape)]
    )


def timing_sheet(timings: Mapping[str, Mapping[str, Any]]) -> Sheet:
    """Panels of period, lateness of the steps, and arrival of every input, a row for each run.

    The numbers are those of `ev_nodes/master/real_time.py`.
    """
    panels = [
        panel
        for name, timing in timings.items()
        for panel in (
            histograms(f"{readable(name)}: period", {"": timing["period"]}),
            histograms(f"{readable(name)}: lateness of steps", {"": timing["lateness"]}),
            histograms(f"{readable(name)}: arrival after the instant was due", timing["arrival"]),
        )
    ]
    return Sheet(panels, columns=3)


def histograms(title: str, counted: Mapping[str, Mapping[str, Any]]) -> Panel:
    """Times counted in bins (`ev_nodes/master/real_time.py`), by label."""

    def stairs(axes: Axes) -> None:
        for number, (label, histogram) in enumerate(counted.items()):
            edges = histogram["edges"]
            colour, dashes = stroke(number)
            # The outer bins are open; a logarithmic axis needs ends, half and twice the next ones.
            ends = [1e3 * end for end in (edges[0] / 2, *edges, 2 * edges[-1])]
            axes.stairs(
                histogram["counts"], ends, color=colour, linestyle=dashes, label=label or None
            )
        axes.set_xscale("log")
        # Logarithmic, for one late step among thousands has to be seen, and 0 has no logarithm.
        axes.set_yscale("symlog", linthresh=1.0)
        axes.set_ylim(0.0, None)

    return Panel(title, "count", ground=stairs if counted else None, xlabel="delay [ms]")
