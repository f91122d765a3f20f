"""Stretches of a cycle as coloured bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from ev_sim.profiles.windows_by_rule import MODES, TRACTION
from ev_sim.report.figures.figure import Axes, Figure

# The surfaces that are mixed most often, snow and wet asphalt, differ in lightness, so they do in print.
SURFACE_COLOURS = {
    "dry_asphalt": "#1A1A1A",
    "wet_asphalt_1": "#5B6770",
    "wet_asphalt_2": "#8A959C",
    "packed_snow_1": "#CFE8F7",
    "packed_snow_2": "#E6D9F0",
    "ice": "#7BD3EA",
    "dry_asphalt_burckhardt": "#403830",
}
MODE_COLOURS = dict(zip(MODES, ("#F2F2F2", "#F4B183", "#A9D18E"), strict=True))
_SHADE = "#FBF1E8"  # behind curves: that of traction, hardly visible


def stretches(time: np.ndarray, names: np.ndarray) -> list[tuple[float, float, str]]:
    """Start and end [s] of each stretch with one name, of names (n,) str over time (n,) [s]."""
    changes = np.flatnonzero(names[1:] != names[:-1]) + 1
    edges = [0, *changes.tolist(), len(names) - 1]
    return [(float(time[a]), float(time[b]), str(names[a])) for a, b in pairwise(edges)]


def draw_strip(axes: Axes, pieces: Sequence[tuple[float, float, str]], colours: Mapping[str, str], name: str) -> None:
    """A strip of colours over time, its name in place of an ordinate."""
    axes.broken_barh(
        [(start, end - start) for start, end, _ in pieces],
        (0.0, 1.0),
        facecolors=[colours[piece] for _, _, piece in pieces],
        linewidth=0.0,
    )
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_ylabel(name, rotation="horizontal", ha="right", va="center", fontsize=8.0)


def shade_traction(figure: Figure, pieces: Sequence[tuple[float, float, str]]) -> None:
    """A faint ground behind the traction windows in all axes of a figure over time."""
    for axes in figure.axes:
        limits = axes.get_xlim()
        for start, end, mode in pieces:
            if mode == MODES[TRACTION]:
                axes.axvspan(start, end, facecolor=_SHADE, edgecolor="none", zorder=0)
        axes.set_xlim(limits)
