"""Figures of matplotlib, which takes longer to load than many a run: it is loaded when the first figure is made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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
