"""The figure of a board: performance profiles, and handling over energy with the laws that no other one dominates."""

from __future__ import annotations

import numpy as np

from ev_stack.figures.panels import Axes, Curve, Panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import DASHES, strokes_of
from ev_study.benchmark.ranking.distributions import COSTS_SHOWN
from ev_study.benchmark.ranking.result import BoardResult

# a point has no dashes to tell laws of one colour apart by
MARKERS = dict(zip(DASHES, "osD^", strict=True))


def board_sheet(result: BoardResult) -> Sheet:
    """Shares of runs below a cost for both costs, and the middle costs of all laws against each other."""
    profiles = [
        Panel(
            f"Performance profile, {cost}",
            "share of runs",
            [Curve(COSTS_SHOWN, of.value[i], readable(law)) for i, law in enumerate(result.laws)],
            ends=(0.0, 1.0),
            xlabel=f"cost of {cost}, at most",
        )
        for cost, of in result.profiles.items()
    ]
    return Sheet([*profiles, _pareto(result)], columns=3)


def undominated(points: np.ndarray) -> list[int]:
    """The rows of points (n, 2) that no other row is below in one number and not above in the other."""
    return [
        i
        for i, point in enumerate(points)
        if not ((points <= point).all(axis=1) & (points < point).any(axis=1)).any()
    ]


def _pareto(result: BoardResult) -> Panel:
    energy, handling = result.scores["energy"], result.scores["handling"]
    points = np.array([[e.value, h.value] for e, h in zip(energy, handling, strict=True)])
    front = points[undominated(points)]
    front, strokes = front[np.argsort(front[:, 0])], strokes_of(result.laws)

    def ground(axes: Axes) -> None:
        axes.plot(*front.T, drawstyle="steps-post", color="0.7", zorder=0)
        for law, e, h in zip(result.laws, energy, handling, strict=True):
            # Distances from the value to the ends of its interval, as errorbar takes them.
            across, along = ([[of.value - of.low], [of.high - of.value]] for of in (h, e))
            colour, dashes = strokes[readable(law)]
            how = {"color": colour, "marker": MARKERS[dashes], "ms": 3}
            axes.errorbar(e.value, h.value, across, along, **how)
            # the legend has the line with its point
            axes.plot([], [], linestyle=dashes, label=readable(law), **how)

    return Panel(
        "Handling over energy, Pareto front grey",
        "handling",
        ground=ground,
        xlabel="energy",
        shape=1.0,
    )
