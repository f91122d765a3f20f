"""Images of the pages, small enough for a repository."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheets, drawn

COLOURS = 256  # lines and letters need no more; a third of the size


def save_small(sheets: Sheets, folder: Path) -> None:
    """Write each figure as NAME.png with a palette of few colours."""
    with TemporaryDirectory() as large:
        for path in save_figures(drawn(sheets), large):
            save_image(path, folder / path.name)


def save_image(large: Path, small: Path) -> None:
    """Write an image with a palette of few colours."""
    Image.open(large).convert("RGB").quantize(COLOURS).save(small, optimize=True)
