"""All panels of all sources as images, and the page that shows them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ev_stack.figures.panels import Panel
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheet, drawn
from ev_stack.recording.recording import atomic_file
from ev_stack.report.page.writing import filled
from ev_study.verdicts.need import Driven, Need
from ev_study.verdicts.sources import source_named

Draw = Callable[..., Sheet]  # takes what was driven, one argument for each of the needs
INDEX = "index.html"


@dataclass(frozen=True, slots=True)
class PublishedPanel:
    """One panel of a source: `figure` is its number there, `letter` that of the panel, empty if there is one only.

    `row`: what the panels have in common that stand side by side. `ids`: the published ids that it
    shows. `needs`: what is driven; `draw` makes the figure of it. A panel that cannot be drawn has
    `why_not` instead.
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
        return "_".join(
            ["fig", self.figure.replace(".", "_"), *([self.letter] if self.letter else [])]
        )

    @property
    def title(self) -> str:
        """Title on the page."""
        return f"Fig {self.figure}{' ' if self.letter else ''}{self.letter}"


def over_time(
    panel: Callable[..., Panel],
    xlabel: str = "time [s]",
    start: float | None = None,
    ends: tuple[float | None, float | None] = (None, None),
) -> Draw:
    """The function that draws one pair of axes over time, or over another abscissa.

    `start` is the begin of the abscissa, `ends` are those of the ordinate where the source has
    them.
    """

    def draw(*driven: object) -> Sheet:
        return Sheet([replace(panel(*driven), ends=ends)], xlabel, start=start)

    return draw


def cannot_be_drawn(figure: str, letter: str, row: str, why: str, *ids: str) -> PublishedPanel:
    """A panel of which too little is left to draw it."""
    return PublishedPanel(figure, letter, row, ids, why_not=why)


def scheme(figure: str, of: str, id: str) -> PublishedPanel:
    """A figure that is a scheme of something, in the row of all schemes."""
    return cannot_be_drawn(
        figure, "", "Schemes", f"a scheme of {of}, no quantity over another one", id
    )


def panels(source: str) -> tuple[PublishedPanel, ...]:
    """The panels of a source, in its order."""
    return source_named(source).PANELS


def file_name(source: str, panel: PublishedPanel) -> str:
    """The image of a panel; every panel of every source has its own."""
    return f"{source}_{panel.name}.png"


def images_by_id(source: str) -> dict[str, list[str]]:
    """The images that show an id, of all ids of a source that are drawn."""
    found: dict[str, list[str]] = {}
    for panel in panels(source):
        # A panel that cannot be drawn shows no id.
        for id in panel.ids if panel.draw else ():
            found.setdefault(id, []).append(file_name(source, panel))
    return found


def draw_panels(
    source: str, shown: Sequence[PublishedPanel], driven: Mapping[Need, Driven], folder: Path
) -> list[Path]:
    """Draw those panels of a source that can be drawn."""
    sheets = {
        Path(file_name(source, panel)).stem: panel.draw(*(driven[need] for need in panel.needs))
        for panel in shown
        if panel.draw
    }
    return save_figures(drawn(sheets), folder)


def write_page(shown: Mapping[str, Sequence[PublishedPanel]], folder: Path) -> Path:
    """Write index.html: the panels of each source, those of a row side by side.

    What cannot be drawn says why.
    """
    page = folder / INDEX
    with atomic_file(page) as file:
        file.write(filled("panels.html", shown=shown, file_name=file_name).encode())
    return page
