"""Figures as data, and their layout on the screen and on the pages of a journal.

How it works: a sheet is laid out in inches: `_Page` knows the height of each row of panels from a
few constants, so it knows how many rows a page takes before anything is drawn. Only the legend and
long titles are measured when they are there; where a page turns out too tall by them, it is drawn
again with fewer rows.
"""

from __future__ import annotations

import itertools
import math
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.figures.panels import DPI, Axes, Panel, readable
from ev_stack.figures.strokes import Stroke, strokes_of

if TYPE_CHECKING:
    from matplotlib.text import Text

    from ev_stack.figures.notebook import Figure
else:
    Figure = Text = Any

STYLE = "ev_stack.figures.journal"
COLUMN, WIDE, TALLEST = 3.5, 7.2, 9.0  # of a column and a page, and the height of a page [inch]
NARROWEST, WIDEST = 1.0, 40.0  # that can be asked for [inch]
_NARROWEST = 2.3  # of a panel beside others [inch]
_HIGH, _FLAT = 1.15, 0.3  # of the axes of a panel [inch], and of one that is alone, over its width
_TICKS = 5.0  # of an ordinate, at most [1/inch]
# of axes: ordinate, title, abscissa with its label [inch]
_BESIDE, _ABOVE, _BELOW = 0.72, 0.22, 0.36
_LINE = 0.13  # of a title [inch]


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """A figure: panels in reading order, `columns` abreast where there is room, over one abscissa.

    The abscissa begins at `start` if that is given.
    """

    panels: Sequence[Panel]
    xlabel: str = "time [s]"
    columns: int = 2
    start: float | None = None

    @property
    def labels(self) -> list[str]:
        """The names of its curves."""
        return [
            curve.label for panel in self.panels for curve in panel.curves if not curve.published
        ]

    def figure(self, width: float = WIDE) -> Figure:
        """The figure [inch], however tall; ParameterError if there is nothing to draw."""
        found = drawn({"": self}, width)
        if not found:
            raise ParameterError("there is nothing to draw, expected a figure with curves")
        return found[""]


Sheets = Mapping[str, Sheet]  # by the name of the file without suffix


def drawn(sheets: Sheets, width: float = WIDE) -> dict[str, Figure]:
    """Draw the figures of a report, without those that would show nothing.

    A name has the same stroke in all of them.
    """
    strokes = _strokes(sheets)
    pages = {name: list(_pages(sheet, width, math.inf, strokes)) for name, sheet in sheets.items()}
    return {name: page for name, found in pages.items() for page in found}


def printed(sheets: Sheets, width: float = COLUMN, panels: Sequence[str] = ()) -> dict[str, Figure]:
    """Draw the figures for print, at most TALLEST, in as many pages as needed: NAME, NAME_2, ...

    `panels`: patterns of NAME, PANEL or NAME.PANEL; empty for all. ParameterError for one that fits
    none.
    """
    strokes = _strokes(sheets)
    return {
        f"{name}_{number}" if number > 1 else name: page
        for name, sheet in chosen(sheets, panels).items()
        for number, page in enumerate(_pages(sheet, width, TALLEST, strokes), start=1)
    }


def panel_name(panel: Panel) -> str:
    """Its title as a name: yaw_rate."""
    return re.sub(r"\W+", "_", panel.title.lower()).strip("_")


def _strokes(sheets: Sheets) -> dict[str, Stroke]:
    return strokes_of(label for sheet in sheets.values() for label in sheet.labels)


def chosen(sheets: Sheets, patterns: Sequence[str]) -> dict[str, Sheet]:
    """Figures with those panels that patterns of NAME, PANEL or NAME.PANEL choose; all without.

    ParameterError for one that fits none.
    """
    if not patterns:
        return dict(sheets)
    names = {name: [panel_name(panel) for panel in sheet.panels] for name, sheet in sheets.items()}

    def fits(pattern: str, name: str, panel: str) -> bool:
        return any(fnmatchcase(each, pattern) for each in (name, panel, f"{name}.{panel}"))

    for pattern in patterns:
        if not any(fits(pattern, name, panel) for name, found in names.items() for panel in found):
            raise unknown_name(
                "panel",
                pattern,
                [f"{name}.{panel}" for name, found in names.items() for panel in found],
            )
    kept = {
        name: [
            panel
            for panel in sheet.panels
            if any(fits(each, name, panel_name(panel)) for each in patterns)
        ]
        for name, sheet in sheets.items()
    }
    return {name: replace(sheets[name], panels=panels) for name, panels in kept.items() if panels}


def _pages(
    sheet: Sheet, width: float, tallest: float, strokes: Mapping[str, Stroke]
) -> Iterator[Figure]:
    """The figures of a sheet, none if it would show nothing."""
    if not NARROWEST <= width <= WIDEST:
        expected = f"expected {NARROWEST:g} to {WIDEST:g} inches"
        raise ParameterError(f"width: {width:g} is refused, {expected}")
    panels = [panel for panel in sheet.panels if not panel.is_empty]
    columns = max(1, min(sheet.columns, len(panels), int(width / _NARROWEST)))
    rows = [panels[n : n + columns] for n in range(0, len(panels), columns)]
    page = _Page(sheet, width, columns, strokes, _spans(panels))
    while rows:
        # A first guess without legend and shared abscissa, which are known only when it is drawn.
        count = page.fitting(rows, tallest)
        figure = page.drawn(rows[:count])
        if figure.get_figheight() > tallest:
            # legend and shared abscissa
            others = figure.get_figheight() - sum(map(page.height, rows[:count]))
            count = page.fitting(rows[:count], tallest - others)
            figure = page.drawn(rows[:count])
        yield figure
        rows = rows[count:]


def _spans(panels: Sequence[Panel]) -> dict[int, tuple[float, float] | None]:
    """Lowest and highest value of each panel, alike for all of one scale.

    None where it is empty.
    """
    together: dict[str, tuple[float, float]] = {}
    for panel in panels:
        if panel.scale and (span := panel.span):
            low, high = together.get(panel.scale, span)
            together[panel.scale] = (min(low, span[0]), max(high, span[1]))
    return {id(panel): together.get(panel.scale, panel.span) for panel in panels}


@dataclass(frozen=True, slots=True)
class _Page:
    """Draws rows of panels of a sheet as a figure of a width [inch]."""

    sheet: Sheet
    width: float
    columns: int
    strokes: Mapping[str, Stroke]
    spans: Mapping[int, tuple[float, float] | None]

    @property
    def _across(self) -> float:
        """Width of the axes of a panel [inch]."""
        return self.width / self.columns - _BESIDE

    def height(self, row: Sequence[Panel]) -> float:
        """Height of a row, with titles and labels of its own [inch]."""
        return max(self._axes_height(panel) + _BELOW * bool(panel.xlabel) for panel in row) + _ABOVE

    def fitting(self, rows: Sequence[Sequence[Panel]], room: float) -> int:
        """Number of rows that have room [inch], at least one."""
        return max(1, sum(end <= room for end in itertools.accumulate(map(self.height, rows))))

    def _axes_height(self, panel: Panel) -> float:
        alone = _FLAT * self.width if len(self.sheet.panels) == 1 else 0.0
        return panel.shape * self._across if panel.shape else max(_HIGH, alone)

    def drawn(self, rows: Sequence[Sequence[Panel]]) -> Figure:
        """Some rows under one legend."""
        from matplotlib import style

        # After a reset: a user's own settings of matplotlib do not change the figures of a report.
        with style.context(STYLE, after_reset=True):
            return self._drawn(rows)

    def _drawn(self, rows: Sequence[Sequence[Panel]]) -> Figure:
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        from ev_stack.figures.notebook import Figure

        figure = Figure(figsize=(self.width, 1.0), dpi=DPI)
        FigureCanvasAgg(figure)  # measures texts
        grid = figure.add_gridspec(
            len(rows), self.columns, height_ratios=[self.height(row) for row in rows]
        )
        panels = [panel for row in rows for panel in row]
        limits = _time_limits(self.sheet.panels, self.sheet.start)
        lines = [0] * len(rows)  # of the longest title beyond its first one
        ends = [False] * len(rows)  # with the abscissa of the sheet, below which there is another
        for number, panel in enumerate(panels):
            row, column = divmod(number, self.columns)
            under = panels[number + self.columns : number + self.columns + 1]
            is_last = not under or bool(under[0].xlabel)
            ends[row] |= is_last and not panel.xlabel
            axes = figure.add_subplot(grid[row, column])
            panel.draw(axes, self.strokes, self._across)
            self._finish(axes, panel, limits, is_last)
            lines[row] = max(lines[row], axes.get_title(loc="left").count("\n"))
        height = sum(map(self.height, rows)) + _LINE * sum(lines) + _BELOW * sum(ends)
        # The legend comes on top: its height is known only once it is laid out.
        figure.set_figheight(height + _legend(figure, self.width, self.strokes))
        figure.align_ylabels()
        return figure

    def _finish(self, axes: Axes, panel: Panel, limits: tuple[float, float], is_last: bool) -> None:
        """Title, labels and limits."""
        _wrap(axes.set_title(panel.title), self._across)
        _wrap(axes.set_ylabel(panel.ylabel), self._axes_height(panel))
        if panel.xlabel:
            axes.set_xlabel(panel.xlabel)
        else:
            axes.set_xlim(*limits)
            axes.set_xlabel(self.sheet.xlabel if is_last else "")
            axes.tick_params(labelbottom=is_last)
        _wrap(axes.xaxis.label, self._across)
        if (span := self.spans[id(panel)]) and not panel.xlabel:
            low, high = span
            # a constant is no noise
            margin = max(0.06 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-6)
            axes.set_ylim(low - margin, high + margin)
        if panel.curves:
            axes.locator_params(axis="y", nbins=max(2, int(_TICKS * self._axes_height(panel))))
        if panel.ends != (None, None):
            axes.set_ylim(*panel.ends)
        if panel.note:
            note = axes.text(
                0.5,
                0.5,
                panel.note,
                transform=axes.transAxes,
                ha="center",
                va="center",
                color="0.4",
            )
            _wrap(note, self._across)


def _time_limits(panels: Sequence[Panel], start: float | None) -> tuple[float, float]:
    times = [
        curve.time
        for panel in panels
        if not panel.xlabel
        for curve in panel.curves
        if len(curve.time)
    ]
    begin = min((float(time[0]) for time in times), default=0.0) if start is None else start
    end = max((float(time[-1]) for time in times), default=begin)
    return begin, end if end > begin else begin + 1.0


def _legend(figure: Figure, width: float, strokes: Mapping[str, Stroke]) -> float:
    """Place one legend for all panels in as few rows as fit, and return its height [inch].

    Names stand in the order of the report.
    """
    entries = {
        label: handle
        for axes in figure.axes
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if not entries:
        return 0.0
    places = {name: place for place, name in enumerate(strokes)}
    entries = dict(
        sorted(entries.items(), key=lambda entry: places.get(readable(entry[0]), len(places)))
    )

    for rows in range(1, len(entries) + 1):
        # Rounded up, so that all entries fit into the rows.
        columns = -(-len(entries) // rows)
        legend = figure.legend(entries.values(), entries, loc="outside upper center", ncols=columns)
        box = legend.get_window_extent()
        if box.width <= width * DPI or columns == 1:
            break
        legend.remove()
    for handle, label in zip(legend.legend_handles, entries, strict=True):
        if own := strokes.get(readable(label)):
            handle.set_linestyle(own.dashes)  # also of a curve that takes turns with others
    if box.width > width * DPI:
        for text in legend.get_texts():
            _wrap(text, width - _BESIDE)
        box = legend.get_window_extent()
    return float(box.height) / DPI + 0.05


def _wrap(text: Text, most: float) -> None:
    """Break a text into lines that are no longer than `most` [inch]."""
    words = text.get_text()
    box = text.get_window_extent()
    length = max(box.width, box.height) / DPI
    letters = len(words)
    while length > most and letters > 4:
        # In proportion to the excess, and at least one letter less, so that the loop ends.
        letters = min(letters - 1, int(letters * most / length))
        text.set_text(textwrap.fill(words, letters))
        box = text.get_window_extent()
        length = (box.height if text.get_rotation() else box.width) / DPI
