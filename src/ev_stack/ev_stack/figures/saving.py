"""Figures as files: PNG for the screen; PDF and SVG for print."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from ev_stack.figures.sheets import COLUMN, STYLE, Figure, Sheets, printed
from ev_stack.recording.recording import atomic_file

Format = Literal["pdf", "svg"]  # for print, beside PNG for the screen
FORMATS = get_args(Format)
_SCREEN = ("png",)
# Two equal figures are equal files; the lightest compression costs some kilobytes and saves half of
# the time to save.
_HOW = {
    "png": {"pil_kwargs": {"compress_level": 1}},
    "pdf": {"metadata": {"CreationDate": None}},
    "svg": {"metadata": {"Date": None}},
}


@dataclass(frozen=True, slots=True)
class Print:
    """Figures for print: FORMATS (none for none), width [inch], and patterns of panels."""

    formats: tuple[str, ...] = ()
    width: float = COLUMN
    panels: tuple[str, ...] = ()

    def drawn(self, sheets: Sheets) -> dict[str, Figure]:
        """Draw the figures for print; ParameterError for a pattern that fits no panel."""
        return printed(sheets, self.width, self.panels) if self.formats else {}

    def save(self, sheets: Sheets, folder: Path) -> None:
        """Write the figures for print; ParameterError for a pattern that fits no panel."""
        save_figures(self.drawn(sheets), folder, self.formats)


def save_figures(
    figures: Mapping[str, Figure], folder: Path | str, formats: Sequence[str] = _SCREEN
) -> list[Path]:
    """Write each figure as NAME.FORMAT; return the paths."""
    if not figures:
        return []
    from matplotlib import style  # slow to import

    paths = []
    for name, figure in figures.items():
        for kind in formats:
            path = Path(folder) / f"{name}.{kind}"
            with atomic_file(path) as file, style.context(STYLE, after_reset=True):
                figure.savefig(file, format=kind, **_HOW[kind])
            paths.append(path)
    return paths
