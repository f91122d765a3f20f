"""What a figure shows, before it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ev_sim.report.metric import NotMeasured


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Samples (n,) over time (n,) [s]; the label names the curve where a panel holds several."""

    time: np.ndarray
    values: np.ndarray
    label: str = ""


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes: `ylabel` gives quantity and unit, `note` says why there is nothing to see."""

    title: str
    ylabel: str
    curves: Sequence[Curve]
    note: str = ""


def panel(title: str, ylabel: str, curves: Callable[[], Sequence[Curve]]) -> Panel:
    """The panel with these curves, or with the reason why they cannot be computed."""
    try:
        return Panel(title, ylabel, curves())
    except NotMeasured as why:
        return Panel(title, ylabel, (), f"not measured: {why}")
