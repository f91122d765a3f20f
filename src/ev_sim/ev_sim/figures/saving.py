"""Figures as files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ev_sim.figures.drawing import NARROW_LEGEND, Axes, Figure
from ev_sim.recording.recording import atomic_file

_WIDTH = 3.5  # of a column [inch]
_LEFT, _RIGHT, _BOTTOM = 0.58, 0.08, 0.4  # margins [inch]
_TITLE, _BETWEEN, _LEGEND_ROW = (
    0.24,
    0.1,
    0.145,
)  # above axes, below those without labels, row of a legend [inch]
_TICK_LINE = 0.11  # of labels of ticks that have more than one [inch]
_LOWEST_MAP, _HIGHEST = 0.7, 3.2  # of axes [inch]
_TITLE_SIZE, _TEXT_SIZE = 8.0, 7.0  # [pt]
_CHARACTER, _STROKE = 0.055, 0.4  # of a legend: width of a letter, of a stroke with its gaps [inch]
_PLOT = _WIDTH - _LEFT - _RIGHT


def as_column(figure: Figure) -> None:
    """Stack the axes of a figure in reading order, `_WIDTH` wide, with text that can be read in print.

    Axes keep their height, those of maps their scale; an abscissa that all share is labelled at the bottom only.
    Legends move above their axes, in as many rows as they need.
    """
    figure.set_layout_engine(None)
    inches = figure.get_size_inches()[1]
    heights = [_height(axes, inches) for axes in figure.axes]
    legends = [_entries(axes) if axes.get_legend() else {} for axes in figure.axes]
    common: dict[str, object] = {}
    for legend in (*figure.legends,):
        common.update(zip([text.get_text() for text in legend.get_texts()], legend.legend_handles, strict=True))
        legend.remove()
    if all(legends) and len({tuple(legend) for legend in legends}) == 1 and len(legends) > 1:
        common, legends = {**common, **legends[0]}, [{} for _ in legends]  # one for all
    shared = len({axes.get_xlim() for axes in figure.axes}) == 1
    below = [_foot(axes) if not shared or axes is figure.axes[-1] else _BETWEEN for axes in figure.axes]
    above = [
        (_TITLE if _has_title(axes) else 0.0) + _rows(legend) * _LEGEND_ROW
        for axes, legend in zip(figure.axes, legends, strict=True)
    ]
    total = sum(heights) + sum(below) + sum(above) + _rows(common) * _LEGEND_ROW + 0.08
    figure.set_size_inches(_WIDTH, total)
    top = total - _rows(common) * _LEGEND_ROW - 0.08
    for axes, height, legend, room, foot in zip(figure.axes, heights, legends, above, below, strict=True):
        top -= room + height
        axes.set_position((_LEFT / _WIDTH, top / total, _PLOT / _WIDTH, height / total))
        _restyle(axes, legend, foot > _BETWEEN, figure.axes)
        top -= foot
    if common:
        figure.legend(
            common.values(), common, loc="upper center", bbox_to_anchor=(0.5, 1.0 - 0.06 / total),
            ncols=_columns(common), fontsize=_TEXT_SIZE, borderpad=0.1, **NARROW_LEGEND,
        )  # fmt: skip


def _height(axes: Axes, inches: float) -> float:
    aspect = axes.get_aspect()
    if aspect == "auto":
        return min(axes.get_position().height * inches, _HIGHEST)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    axes.set_aspect(aspect, adjustable="datalim")
    return min(max(_PLOT * aspect * (high - low) / (right - left), _LOWEST_MAP), _HIGHEST)


def _foot(axes: Axes) -> float:
    """What stands below axes: label, ticks and their further lines [inch]."""
    return _BOTTOM + _TICK_LINE * max((label.get_text().count("\n") for label in axes.get_xticklabels()), default=0)


def _entries(axes: Axes) -> dict[str, object]:
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def _has_title(axes: Axes) -> bool:
    return any(axes.get_title(loc=place) for place in ("left", "center", "right"))


def _columns(legend: dict[str, object]) -> int:
    widest = max(map(len, legend)) * _CHARACTER + _STROKE
    return max(1, min(len(legend), int(_PLOT / widest)))


def _rows(legend: dict[str, object]) -> int:
    return -(-len(legend) // _columns(legend)) if legend else 0


def _restyle(axes: Axes, legend: dict[str, object], labelled: bool, all_axes: Sequence[Axes]) -> None:
    if axes.get_legend():
        axes.get_legend().remove()
    if legend:
        axes.legend(
            legend.values(), legend, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=_columns(legend),
            fontsize=_TEXT_SIZE, borderpad=0.1, **NARROW_LEGEND,
        )  # fmt: skip
    for place in ("left", "center", "right"):
        if text := axes.get_title(loc=place):
            axes.set_title(text, loc=place, fontsize=_TITLE_SIZE, pad=3 + _rows(legend) * _LEGEND_ROW * 72)
    axes.tick_params(labelsize=_TEXT_SIZE, labelbottom=labelled, labelleft=True)
    axes.set_xlabel((axes.get_xlabel() or all_axes[-1].get_xlabel()) if labelled else "", fontsize=_TEXT_SIZE)
    axes.yaxis.label.set(text=axes.get_ylabel() or all_axes[0].get_ylabel(), fontsize=_TEXT_SIZE)
    if axes.yaxis.label.get_rotation() > 0.0:  # the name of a strip lies at its own place
        axes.yaxis.set_label_coords(-0.48 / _PLOT, 0.5)


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
