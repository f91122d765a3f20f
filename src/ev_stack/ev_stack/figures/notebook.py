"""Figures that a notebook shows; this module imports matplotlib, and is imported to draw."""

from __future__ import annotations

import io

from matplotlib.figure import Figure as FigureOfMatplotlib

from ev_stack.figures.panels import DPI


class Figure(FigureOfMatplotlib):
    """A figure of matplotlib that shows itself in a notebook without its pyplot."""

    def png(self) -> bytes:
        """The figure as a file for the screen."""
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=DPI)
        return file.getvalue()

    _repr_png_ = png
