"""Figures of matplotlib as images of a page, with what they show in words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ev_sim.report.figures.figure import Figure
from ev_sim.report.page.writing import Image


def images_of(figures: Mapping[str, Figure], folder: Path) -> dict[str, Image]:
    """The files NAME.png that were saved in a folder; what they show are titles and labels of their axes."""
    return {name: Image((folder / f"{name}.png").read_bytes(), _shown(figure)) for name, figure in figures.items()}


def _shown(figure: Figure) -> str:
    panels = []
    for axes in figure.axes:
        title = axes.get_title(loc="left") or axes.get_title()
        labels = " over ".join(filter(None, (axes.get_ylabel(), axes.get_xlabel())))
        panels.append(": ".join(filter(None, (title, labels))))
    return "; ".join(dict.fromkeys(filter(None, panels)))
