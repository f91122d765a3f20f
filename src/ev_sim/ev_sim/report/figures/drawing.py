"""Sheets of time series as PNG files. Imports matplotlib: import this module only where something is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ev_sim.report.figures.panels import Curve, Panel
from ev_sim.run.recording.atomic import atomic_file

DPI = 110
PANEL_WIDTH, PANEL_HEIGHT = 4.6, 1.9  # of a panel with its labels [inch]
TITLE_SIZE, TEXT_SIZE = 9.0, 8.0  # [pt]

# Okabe and Ito's colours can be told apart with every kind of colour vision; the dashes also in print, and they
# let a curve be seen under another one.
SOLID, DASHED, DOTTED, MIXED = "-", (0, (4, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2))
STROKES = (
    ("#0072B2", SOLID),
    ("#D55E00", DASHED),
    ("#009E73", DOTTED),
    ("#CC79A7", MIXED),
    ("#56B4E9", SOLID),
    ("#E69F00", DASHED),
    ("#000000", DOTTED),
    ("#7F7F7F", MIXED),
    ("#009E73", SOLID),
    ("#0072B2", DASHED),
    ("#D55E00", DOTTED),
    ("#56B4E9", MIXED),
)
CHARACTER, STROKE = 0.06, 0.37  # width of a letter of a legend, and of a stroke with its gaps [inch]
LEGEND_COLUMNS, LEGEND_ROW = 5, 0.17  # of that legend, the height of a row in [inch]


def sheet(
    panels: Sequence[Panel],
    xlabel: str,
    columns: int = 2,
    start: float | None = None,
    panel_width: float = PANEL_WIDTH,
) -> Figure:
    """A figure with the panels in reading order over one time axis, which begins at `start` [s] if that is given.

    A panel with its labels is `panel_width` [inch] wide.
    """
    rows = -(-len(panels) // columns)
    apart = list(
        dict.fromkeys(c.label for p in panels if not _legend_fits(p, panel_width) for c in p.curves if c.label)
    )
    above = LEGEND_ROW * -(-len(apart) // LEGEND_COLUMNS) + 0.1 if apart else 0.0
    width, height = panel_width * columns, PANEL_HEIGHT * rows + 0.35 + above
    figure = Figure(figsize=(width, height), dpi=DPI)
    # Fixed margins: matplotlib's layout engines draw everything twice to find them.
    figure.subplots_adjust(
        left=0.72 / width,
        right=1 - 0.12 / width,
        bottom=0.45 / height,
        top=1 - (0.28 + above) / height,
        wspace=0.85 / (panel_width - 0.85),
        hspace=0.45 / (PANEL_HEIGHT - 0.45),
    )
    begin, end = _time_limits(panels, start)
    for number, panel in enumerate(panels):
        axes = figure.add_subplot(rows, columns, number + 1)
        _draw(axes, panel, panel_width)
        axes.set_xlim(begin, end)
        if number + columns >= len(panels):
            axes.set_xlabel(xlabel, fontsize=TEXT_SIZE)
        else:
            axes.tick_params(labelbottom=False)
    if apart:
        lines = {line.get_label(): line for axes in figure.axes for line in axes.lines}
        handles = [lines[label] for label in apart]
        figure.legend(handles, apart, loc="upper center", ncols=LEGEND_COLUMNS, fontsize=TEXT_SIZE, frameon=False)
    return figure


def save_figures(figures: Mapping[str, Figure], folder: Path | str) -> list[Path]:
    """Write each figure as NAME.png and return the paths."""
    paths = []
    for name, figure in figures.items():
        path = Path(folder) / f"{name}.png"
        with atomic_file(path) as file:
            # The lightest compression costs some kilobytes and saves half of the time to save.
            FigureCanvasAgg(figure).print_png(file, pil_kwargs={"compress_level": 1})
        paths.append(path)
    return paths


def thinned(time: np.ndarray, values: np.ndarray, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Samples that draw the same line at `columns` pixels: the lowest and the highest of each, and both ends.

    NaN counts as lowest and highest, so a gap stays a gap. Short series come back as they are.
    """
    size = len(values) // columns
    if size <= 4:
        return time, values
    whole = len(values) // size * size
    first = np.arange(0, whole, size)
    bins = values[:whole].reshape(-1, size)
    lowest, highest = first + bins.argmin(axis=1), first + bins.argmax(axis=1)
    # The rest behind the last whole bin is shorter than one bin: keep all of it.
    kept = np.unique(np.concatenate(([0], lowest, highest, np.arange(whole, len(values)), [len(values) - 1])))
    return time[kept], values[kept]


def _time_limits(panels: Sequence[Panel], start: float | None) -> tuple[float, float]:
    times = [curve.time for panel in panels for curve in panel.curves if len(curve.time)]
    begin = min((float(time[0]) for time in times), default=0.0) if start is None else start
    end = max((float(time[-1]) for time in times), default=begin)
    return begin, end if end > begin else begin + 1.0


def _draw(axes: Axes, panel: Panel, width: float) -> None:
    columns = int(width * DPI)
    for number, curve in enumerate(panel.curves):
        colour, dashes = STROKES[number % len(STROKES)]
        time, values = thinned(curve.time, curve.values, columns)
        axes.plot(time, values, color=colour, linestyle=dashes, linewidth=1.2, label=curve.label or None)
    axes.set_title(panel.title, loc="left", fontsize=TITLE_SIZE, pad=3)
    axes.set_ylabel(panel.ylabel, fontsize=TEXT_SIZE)
    axes.yaxis.set_label_coords(-0.5 / (width - 0.85), 0.5)  # in line with the panels above and below
    axes.tick_params(labelsize=TEXT_SIZE, length=2.5)
    axes.locator_params(nbins=6)
    axes.grid(True, color="0.88", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if panel.note:
        axes.text(0.5, 0.5, panel.note, transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE, color="0.4")
    own_legend = any(curve.label for curve in panel.curves) and _legend_fits(panel, width)
    if own_legend:
        axes.legend(
            loc="upper right",
            fontsize=TEXT_SIZE,
            frameon=False,
            ncols=len(panel.curves),
            borderaxespad=0.0,
            handlelength=1.8,
            handletextpad=0.4,
            columnspacing=1.0,
        )
    _leave_room(axes, panel.curves, own_legend)


def _legend_fits(panel: Panel, width: float) -> bool:
    """Whether the legend fits into one row of the panel; where one does not, the figure has one above all panels."""
    letters = sum(len(curve.label) for curve in panel.curves)
    return letters * CHARACTER + len(panel.curves) * STROKE <= width - 0.85


def _leave_room(axes: Axes, curves: Sequence[Curve], own_legend: bool) -> None:
    """Limits in which a constant does not look like noise and the legend stands above the curves."""
    finite = [curve.values[np.isfinite(curve.values)] for curve in curves]
    finite = [values for values in finite if len(values)]
    if not finite:
        return
    low, high = min(float(v.min()) for v in finite), max(float(v.max()) for v in finite)
    margin = max(0.06 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-6)
    axes.set_ylim(low - margin, high + margin * (4.5 if own_legend else 1.0))
