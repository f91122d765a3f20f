"""Images of the pages, small enough for a repository."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from PIL import Image

from ev_sim.figures.saving import save_figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = 256  # lines and letters need no more; a third of the size


def save_small(figures: Mapping[str, Figure], folder: Path) -> None:
    """Write each figure as NAME.png with a palette of few colours."""
    with TemporaryDirectory() as large:
        for path in save_figures(figures, large):
            Image.open(path).convert("RGB").quantize(COLOURS).save(folder / path.name, optimize=True)
