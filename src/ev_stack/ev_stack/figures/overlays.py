"""Figures of several results over each other, and the panels of many figures as one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ev_stack.figures.panels import Panel, readable
from ev_stack.figures.sheets import Sheet, Sheets, chosen
from ev_stack.figures.strokes import PART


def overlaid(named: Mapping[str, Sheets]) -> dict[str, Sheet]:
    """Lay the figures of several reports over each other; names stand before those of curves."""
    found: dict[str, dict[tuple[str, ...], Panel]] = {}
    first: dict[str, Sheet] = {}
    for name, sheets in named.items():
        for figure, sheet in sheets.items():
            first.setdefault(figure, sheet)
            panels = found.setdefault(figure, {})
            for panel in sheet.panels:
                # A view from above has its scale in the title, which differs with the paths.
                title = "" if panel.ground else panel.title
                place = (title, panel.ylabel, panel.xlabel)
                panels[place] = _over(panels.get(place), panel, name)
    return {name: replace(first[name], panels=[*panels.values()]) for name, panels in found.items()}


def _over(below: Panel | None, panel: Panel, name: str) -> Panel:
    """The panel with its curves named, over those of the results before it."""
    curves = [] if below is None else [*below.curves]
    own = [curve for curve in panel.curves if not curve.published]
    for curve in panel.curves:
        if not curve.published:
            # The only curve of a result is the result itself, whatever its report calls it.
            is_part = len(own) > 1 and curve.label
            label = f"{readable(name)}{PART}{curve.label}" if is_part else readable(name)
            curves.append(replace(curve, label=label))
        elif below is None:
            curves.append(curve)
    if below is None:
        return replace(panel, curves=curves)
    # Why one result has no curve is no note on a panel in which another has one.
    return replace(below, curves=curves, note="" if curves else below.note)


def as_one(sheets: Sheets, patterns: Sequence[str] = ()) -> Sheet:
    """The panels of all figures on one sheet, or those that patterns choose.

    ParameterError for a pattern that fits none.
    """
    panels = []
    time = Sheet(()).xlabel
    for sheet in chosen(sheets, patterns).values():
        for panel in sheet.panels:
            own = "" if sheet.xlabel == time else sheet.xlabel
            panels.append(replace(panel, xlabel=panel.xlabel or own))
    return Sheet(panels)
