"""A panel of a published figure, and how we draw it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ev_sim.report.figures.drawing import sheet
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Panel
from ev_sim.verdicts.need import Need

WIDTH = 6.2  # of a panel with its labels [inch]
Draw = Callable[..., "Figure"]  # takes what was driven, one argument for each of the needs


@dataclass(frozen=True, slots=True)
class PublishedPanel:
    """One panel of a source: `figure` is its number there, `letter` that of the panel, empty if there is one only.

    `row`: what the panels have in common that stand side by side. `ids`: the ids of config/published that it shows.
    `needs`: what is driven; `draw` makes the figure of it. A panel that cannot be drawn has `why_not` instead.
    """

    figure: str
    letter: str
    row: str
    ids: tuple[str, ...] = ()
    needs: tuple[Need, ...] = ()
    draw: Draw | None = None
    why_not: str = ""

    @property
    def name(self) -> str:
        """Name of the file without suffix and source."""
        return "_".join(["fig", self.figure.replace(".", "_"), *([self.letter] if self.letter else [])])

    @property
    def title(self) -> str:
        """What it is called on the page."""
        return f"Fig {self.figure}{' ' if self.letter else ''}{self.letter}"


def over_time(
    panel: Callable[..., Panel],
    xlabel: str = "time [s]",
    start: float | None = None,
    ends: tuple[float, float] | None = None,
) -> Draw:
    """The function that draws one pair of axes over time, or over another abscissa.

    `start` is the begin of the abscissa, `ends` are those of the ordinate where the source has them.
    """

    def draw(*driven: object) -> Figure:
        figure = sheet([panel(*driven)], xlabel, columns=1, start=start, panel_width=WIDTH)
        if ends:
            figure.axes[0].set_ylim(*ends)
        return figure

    return draw


def cannot_be_drawn(figure: str, letter: str, row: str, why: str, *ids: str) -> PublishedPanel:
    """A panel of which too little is left to draw it."""
    return PublishedPanel(figure, letter, row, ids, why_not=why)
