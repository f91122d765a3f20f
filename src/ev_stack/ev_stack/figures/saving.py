"""Figures as files: PNG for the screen; PDF and SVG for print."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ev_stack.figures.sheets import COLUMN, STYLE, Figure, Sheets, printed
from ev_stack.recording.recording import atomic_file

FORMATS = ("pdf", "svg")  # for print, beside PNG for the screen
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

    def save(
        self,
        sheets: Sheets,
        folder: Path,
        claim: Callable[[Sequence[str]], None] = lambda names: None,
    ) -> None:
        """Write the figures for print; ParameterError for a pattern that fits no panel."""
        if self.formats:
            figures = printed(sheets, self.width, self.panels)
            claim(figure_files(figures, self.formats))
            save_figures(figures, folder, self.formats)


def figure_files(figures: Iterable[str], formats: Sequence[str] = _SCREEN) -> list[str]:
    """The names of the files of some figures."""
    return [f"{name}.{kind}" for name in figures for kind in formats]


def save_figures(
    figures: Mapping[str, Figure], folder: Path | str, formats: Sequence[str] = _SCREEN
) -> list[Path]:
    """Write each figure as NAME.FORMAT; return the paths."""
    if not figures:
        return []
    from matplotlib import style  # slow to import

    paths = []
    for name in figure_files(figures, formats):
        paths.append(Path(folder) / name)
        stem, _, kind = name.rpartition(".")
        with atomic_file(paths[-1]) as file, style.context(STYLE, after_reset=True):
            figures[stem].savefig(file, format=kind, **_HOW[kind])
    return paths
