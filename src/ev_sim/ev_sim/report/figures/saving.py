"""Figures as files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ev_sim.report.figures.column import as_column
from ev_sim.report.figures.figure import Figure
from ev_sim.running.recording.atomic import atomic_file

FORMATS = ("pdf", "svg")  # for print, beside PNG for the screen
# Letters stay letters, and two equal figures are equal files.
_SETTINGS = {"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "ev_sim"}
_NO_DATE = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}


def figure_files(figures: Iterable[str], formats: Sequence[str] = ()) -> list[str]:
    """The names of the files of some figures."""
    return [f"{name}.{kind}" for name in figures for kind in ("png", *formats)]


def save_figures(figures: Mapping[str, Figure], folder: Path | str, formats: Sequence[str] = ()) -> list[Path]:
    """Write each figure as NAME.png, and in some of FORMATS as wide as a column of a paper; return the paths."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    paths = []
    for name, figure in figures.items():
        paths.append(Path(folder) / f"{name}.png")
        with atomic_file(paths[-1]) as file:
            # The lightest compression costs some kilobytes and saves half of the time to save.
            FigureCanvasAgg(figure).print_png(file, pil_kwargs={"compress_level": 1})
        if formats:
            as_column(figure)
        for kind in formats:
            paths.append(Path(folder) / f"{name}.{kind}")
            with atomic_file(paths[-1]) as file, rc_context(_SETTINGS):
                figure.savefig(file, format=kind, metadata=_NO_DATE[kind])
    return paths
