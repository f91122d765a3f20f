"""Flaws in a figure's layout: texts beyond its edge or over each other, sizes of no journal."""

from __future__ import annotations

from itertools import combinations

import pytest
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from ev_stack.figures.sheets import TALLEST

TOUCH = 0.5  # pixels by which boxes of texts may overlap: their edges are rounded to whole ones


def drawn_texts(figure) -> list[tuple[str, Bbox]]:
    """Every text that is drawn, also ticks, with its box [pixel]."""
    found = []
    draw = Text.draw

    def noted(text: Text, renderer) -> None:
        draw(text, renderer)
        if text.get_visible() and text.get_text().strip():
            found.append((text.get_text(), text.get_window_extent(renderer)))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", noted)
        figure.draw_without_rendering()
    return found


def flaws(figure, width: float) -> list[str]:
    """List the flaws for which an editor would return the figure."""
    wide, tall = figure.get_size_inches()
    found = (
        [] if wide == pytest.approx(width) and tall <= TALLEST else [f"{wide:.2f} x {tall:.2f} in"]
    )
    page, texts = figure.bbox.padded(TOUCH), drawn_texts(figure)
    for text, box in texts:
        if not (
            page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1
        ):
            found.append(f"{text!r} beyond the edge")
    for (one, box), (other, another) in combinations(texts, 2):
        common = Bbox.intersection(box, another)
        if common is not None and min(common.width, common.height) > TOUCH:
            found.append(f"{one!r} over {other!r}")
    return found
