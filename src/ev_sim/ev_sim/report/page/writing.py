"""A page as one file: templates, styles, scripts, signals and figures in one text."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, FunctionLoader

from ev_core.parameters.declaration import entries
from ev_core.vehicle.description import Vehicle
from ev_sim.figures.figure import Figure
from ev_sim.recording.atomic import atomic_file
from ev_sim.report.page.content import Signals, by_result, signal_data


@dataclass(frozen=True, slots=True)
class Image:
    """A PNG file and what it shows, in words."""

    png: bytes
    shows: str

    @property
    def url(self) -> str:
        """The image itself as an address."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


@dataclass(frozen=True)
class Page:
    """What a page shows: `summaries` are contents of summary.json by label, `table` is text of a study."""

    title: str
    summaries: Mapping[str, Mapping[str, Any]]
    signals: Sequence[Signals] = ()
    images: Mapping[str, Image] = field(default_factory=dict)
    table: str = ""


def write_page(page: Page, path: Path) -> None:
    """Write the page, as a whole or not at all."""
    text = filled(
        "report.html",
        page=page,
        metrics=by_result(page.summaries),
        data=signal_data(page.signals),
        car={entry.name: entry.spec for entry in entries(Vehicle)},
    )
    with atomic_file(path) as file:
        file.write(text.encode())


def filled(template: str, **values: Any) -> str:
    """The text of a template with these values, with all styles and scripts that it names."""
    environment = Environment(loader=FunctionLoader(_file), autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["number"] = _number
    environment.globals["file"] = _file
    return environment.get_template(f"templates/{template}").render(**values)


def _file(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _number(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "\u2013"}[value]
    if isinstance(value, float):
        return f"{value:.6g}"
    return ", ".join(map(_number, value)) if isinstance(value, list | tuple) else str(value)


def images_of(figures: Mapping[str, Figure], folder: Path) -> dict[str, Image]:
    """The files NAME.png that were saved in a folder; what they show are titles and labels of their axes."""
    return {name: Image((folder / f"{name}.png").read_bytes(), _shown(figure)) for name, figure in figures.items()}


def _shown(figure: Figure) -> str:
    panels = []
    for axes in figure.axes:
        title = axes.get_title(loc="left") or axes.get_title()
        labels = " over ".join(filter(None, (axes.get_ylabel(), axes.get_xlabel())))
        panels.append(": ".join(filter(None, (title, labels))))
    return "; ".join(dict.fromkeys(filter(None, panels)))
