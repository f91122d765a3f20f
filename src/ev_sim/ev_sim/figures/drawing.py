"""Sheets of time series: what their panels show, and how they are drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle, product
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_sim.figures.thinning import chatter, thinned
from ev_sim.measures import motion
from ev_sim.measures.handling import has_spun
from ev_sim.measures.metric import NotMeasured, Runs, channel
from ev_sim.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
else:
    Axes = Figure = Any

DPI = 110


def new_figure(width: float, height: float, layout: str | None = None) -> Figure:
    """An empty figure of a size [inch]; `layout` names an engine of matplotlib."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), dpi=DPI, layout=layout)


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Samples (n,) over time (n,) [s]; the label names the curve where a panel holds several.

    `published`: what the source says, not a run.
    """

    time: np.ndarray
    values: np.ndarray
    label: str = ""
    published: bool = False
    spun: bool = False  # of a run in which the car has spun: other curves set the limits of the axes


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes: `ylabel` gives quantity and unit, `note` says why there is nothing to see.

    Panels of a sheet with the same `scale` have the same ordinate. `within`: the ends beyond which a curve may leave
    the panel, so that the others are seen.
    """

    title: str
    ylabel: str
    curves: Sequence[Curve]
    note: str = ""
    scale: str = ""
    within: tuple[float, float] | None = None


def panel(
    title: str,
    ylabel: str,
    curves: Callable[[], Sequence[Curve]],
    scale: str = "",
    within: tuple[float, float] | None = None,
) -> Panel:
    """The panel with these curves, or with the reason why they cannot be computed."""
    try:
        return Panel(title, ylabel, curves(), scale=scale, within=within)
    except NotMeasured as why:
        return Panel(title, ylabel, (), f"not measured: {why}")


def level(value: float, start: float, end: float, label: str = "published") -> Curve:
    """A published number as the line that a curve should keep to from `start` to `end` [s]."""
    return Curve(np.array([start, end]), np.array([value, value]), label, published=True)


Quantity = Callable[[Recording], np.ndarray]


def degrees(quantity: Quantity) -> Quantity:
    """An angle [rad] in degrees."""
    return lambda run: np.degrees(quantity(run))


# Title, ordinate and quantity in its unit.
MOTION: dict[str, tuple[str, str, Quantity]] = {
    "steering_wheel_angle": (
        "Steering-wheel angle",
        "angle [deg]",
        degrees(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)),
    ),
    "yaw_rate": ("Yaw rate", "yaw rate [deg/s]", degrees(lambda run: channel(run, motion.YAW_RATE))),
    "lateral_acceleration": ("Lateral acceleration", "acceleration [m/s²]", motion.lateral_acceleration_on_path),
    "sideslip_angle": ("Sideslip angle", "angle [deg]", degrees(motion.sideslip_angle)),
}


def over_time(
    runs: Runs, title: str, ylabel: str, quantity: Quantity, within: tuple[float, float] | None = None
) -> Panel:
    """A quantity of every run, labelled with the name of the run if there are several."""

    def curves() -> list[Curve]:
        labels = [name.replace("_", " ") if len(runs) > 1 else "" for name in runs]
        named = zip(labels, runs.values(), strict=True)
        return [Curve(run.time, quantity(run), label, spun=has_spun(run)) for label, run in named]

    return panel(title, ylabel, curves, within=within)


def motion_panels(runs: Runs, *names: str) -> list[Panel]:
    """Some quantities of MOTION of every run."""
    return [over_time(runs, *MOTION[name]) for name in names]


PANEL_WIDTH, PANEL_HEIGHT = 4.6, 1.9  # of a panel with its labels [inch]
TITLE_SIZE, TEXT_SIZE = 9.0, 8.0  # [pt]

# Okabe and Ito's colours can be distinguished with every kind of colour vision; the dashes also in print, and they
# let a curve be seen under another one.
SOLID, DASHED, DOTTED, MIXED = "-", (0, (4, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2))
_FIRST = (
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
# Behind them all that are left, for as many laws as there may be.
STROKES = tuple(dict.fromkeys((*_FIRST, *product([colour for colour, _ in _FIRST], (SOLID, DASHED, DOTTED, MIXED)))))
CHARACTER, STROKE = 0.06, 0.37  # width of a letter of a legend, and of a stroke with its gaps [inch]
NARROW_LEGEND: dict[str, Any] = {
    "frameon": False, "borderaxespad": 0.0, "columnspacing": 1.0, "handlelength": 1.8, "handletextpad": 0.4
}  # fmt: skip
BAND = "band: lowest to highest, line: mean"
LEGEND_COLUMNS, LEGEND_ROW = 5, 0.17  # of that legend, the height of a row in [inch]


def name_axes(
    axes: Axes,
    title: str,
    xlabel: str = "",
    ylabel: str = "",
    *,
    ticks: float = 2.5,
    grid: str = "both",
    pad: float = 3.0,
) -> None:
    """Title and labels in the letters of all figures, and no frame at the top and on the right.

    `ticks`: how long they are [pt]; `grid`: of which axis there are lines, both, x or y, empty for none; `pad`: between
    title and axes [pt].
    """
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, pad=pad)
    axes.set_xlabel(xlabel, fontsize=TEXT_SIZE)
    axes.set_ylabel(ylabel, fontsize=TEXT_SIZE)
    axes.tick_params(labelsize=TEXT_SIZE, length=ticks)
    if grid:
        axes.grid(True, axis=grid, color="0.88", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def sheet(
    panels: Sequence[Panel], xlabel: str, columns: int = 2, start: float | None = None, panel_width: float = PANEL_WIDTH
) -> Figure:
    """A figure with the panels in reading order over one time axis, which begins at `start` [s] if that is given.

    A panel with its labels is `panel_width` [inch] wide.
    """
    rows = -(-len(panels) // columns)
    apart = list(
        dict.fromkeys(c.label for p in panels if not _legend_fits(p, panel_width) for c in p.curves if c.label)
    )
    width = panel_width * columns
    abreast = _legend_columns(apart, width)
    above = LEGEND_ROW * -(-len(apart) // abreast) + 0.1 if apart else 0.0
    height = PANEL_HEIGHT * rows + 0.35 + above
    figure = new_figure(width, height)
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
    for number, (panel, span) in enumerate(zip(panels, _spans(panels), strict=True)):
        axes = figure.add_subplot(rows, columns, number + 1)
        _draw(axes, panel, panel_width, span)
        axes.set_xlim(begin, end)
        if number + columns >= len(panels):
            axes.set_xlabel(xlabel, fontsize=TEXT_SIZE)
        else:
            axes.tick_params(labelbottom=False)
    if apart:
        lines = {line.get_label(): line for axes in figure.axes for line in axes.lines}
        handles = [lines[label] for label in apart]
        figure.legend(handles, apart, loc="upper center", ncols=abreast, fontsize=TEXT_SIZE, frameon=False)
    return figure


def _time_limits(panels: Sequence[Panel], start: float | None) -> tuple[float, float]:
    times = [curve.time for panel in panels for curve in panel.curves if len(curve.time)]
    begin = min((float(time[0]) for time in times), default=0.0) if start is None else start
    end = max((float(time[-1]) for time in times), default=begin)
    return begin, end if end > begin else begin + 1.0


def _spans(panels: Sequence[Panel]) -> list[tuple[float, float] | None]:
    """Lowest and highest value that each panel shows, alike for all of one scale; None where there is nothing."""
    spans = [_span(panel) for panel in panels]
    of_scale: dict[str, list[tuple[float, float]]] = {}
    for panel, span in zip(panels, spans, strict=True):
        if panel.scale and span:
            of_scale.setdefault(panel.scale, []).append(span)
    together = {scale: (min(low for low, _ in of), max(high for _, high in of)) for scale, of in of_scale.items()}
    return [together.get(panel.scale, span) for panel, span in zip(panels, spans, strict=True)]


def _span(panel: Panel) -> tuple[float, float] | None:
    counted = [curve for curve in panel.curves if not curve.spun] or panel.curves
    finite = [curve.values[np.isfinite(curve.values)] for curve in counted]
    finite = [values for values in finite if len(values)]
    if not finite:
        return None
    low, high = min(float(v.min()) for v in finite), max(float(v.max()) for v in finite)
    return (max(low, panel.within[0]), min(high, panel.within[1])) if panel.within else (low, high)


def _draw(axes: Axes, panel: Panel, width: float, span: tuple[float, float] | None) -> None:
    columns = int(width * DPI)
    ours = [curve for curve in panel.curves if not curve.published]
    for curve, (colour, dashes) in zip(ours, cycle(STROKES), strict=False):
        _draw_curve(axes, curve, columns, {"color": colour, "linestyle": dashes, "linewidth": 1.2})
    for number, curve in enumerate(curve for curve in panel.curves if curve.published):
        label = "_" if number else curve.label  # all that is published is one entry of the legend
        axes.plot(curve.time, curve.values, color="black", linestyle=DOTTED, linewidth=1.6, zorder=3, label=label)
    name_axes(axes, panel.title, ylabel=panel.ylabel)
    axes.yaxis.set_label_coords(-0.5 / (width - 0.85), 0.5)  # in line with the panels above and below
    axes.locator_params(nbins=6)
    if panel.note:
        axes.text(0.5, 0.5, panel.note, transform=axes.transAxes, ha="center", fontsize=TEXT_SIZE, color="0.4")
    own_legend = any(curve.label for curve in panel.curves) and _legend_fits(panel, width)
    if own_legend:
        axes.legend(loc="upper right", fontsize=TEXT_SIZE, ncols=len(_labels(panel)), **NARROW_LEGEND)
    if span:
        _leave_room(axes, *span, own_legend)


def _draw_curve(axes: Axes, curve: Curve, columns: int, stroke: dict[str, Any]) -> None:
    """A line; where it would be solid ink a band from its lowest to its highest values, with their mean."""
    found = chatter(curve.time, curve.values, columns)
    line = curve.values if found is None else found.line
    axes.plot(*thinned(curve.time, line, columns), label=curve.label or None, **stroke)
    if found is None:
        return
    ends = [np.append(each, each[-1]) for each in (found.lowest, found.highest)]
    axes.fill_between(found.edges, *ends, step="post", color=stroke["color"], alpha=0.3, linewidth=0.0)
    axes.plot(found.edges, np.append(found.mean, found.mean[-1]), drawstyle="steps-post", **stroke)
    if not axes.texts:
        axes.text(0.995, 0.03, BAND, transform=axes.transAxes, ha="right", fontsize=TEXT_SIZE - 1.5, zorder=4)


def _legend_fits(panel: Panel, width: float) -> bool:
    """Whether the legend fits into one row of the panel; where one does not, the figure has one above all panels."""
    labels = _labels(panel)
    return sum(map(len, labels)) * CHARACTER + len(labels) * STROKE <= width - 0.85


def _legend_columns(labels: Sequence[str], width: float) -> int:
    """How many entries stand abreast in the legend of a figure of a width [inch]."""
    widest = max(map(len, labels), default=0) * CHARACTER + STROKE + 0.2
    return max(1, min(LEGEND_COLUMNS, int(width / widest)))


def _labels(panel: Panel) -> list[str]:
    return list(dict.fromkeys(curve.label for curve in panel.curves if curve.label))


def _leave_room(axes: Axes, low: float, high: float, own_legend: bool) -> None:
    """Limits in which a constant does not look like noise and the legend stands above the curves."""
    margin = max(0.06 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-6)
    axes.set_ylim(low - margin, high + margin * (4.5 if own_legend else 1.0))
