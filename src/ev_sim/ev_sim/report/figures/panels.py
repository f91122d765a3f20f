"""What a figure shows, before it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ev_sim.report.metric import NotMeasured


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Samples (n,) over time (n,) [s]; the label names the curve where a panel holds several.

    `published`: what the source says, not a run.
    """

    time: np.ndarray
    values: np.ndarray
    label: str = ""
    published: bool = False


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes: `ylabel` gives quantity and unit, `note` says why there is nothing to see.

    Panels of a sheet with the same `scale` have the same ordinate. `within`: the ends beyond which a curve may leave
    the panel, so that the others are seen.
    """

    title: str
    ylabel: str
    curves: Sequence[Curve]
    note: str = ""
    scale: str = ""
    within: tuple[float, float] | None = None


def panel(
    title: str,
    ylabel: str,
    curves: Callable[[], Sequence[Curve]],
    scale: str = "",
    within: tuple[float, float] | None = None,
) -> Panel:
    """The panel with these curves, or with the reason why they cannot be computed."""
    try:
        return Panel(title, ylabel, curves(), scale=scale, within=within)
    except NotMeasured as why:
        return Panel(title, ylabel, (), f"not measured: {why}")


def level(value: float, start: float, end: float, label: str = "published") -> Curve:
    """A published number as the line that a curve should keep to from `start` to `end` [s]."""
    return Curve(np.array([start, end]), np.array([value, value]), label, published=True)
