"""Page as one file from the results of commands: templates, scripts, signals and figures.

How it works: the page holds its signals as text. A channel is rounded to some steps of its range
(`pack`), its differences are deflated, and equal channels are there once. If all together are too
long for a page, first fewer bytes a sample are tried, then an envelope of lowest and highest values
over longer and longer spans. The page's script unpacks what it draws (templates/signals.js).
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jinja2 import Environment, FunctionLoader

from ev_core.parameters.data_file import TIME
from ev_core.parameters.declaration import entries
from ev_core.vehicle.description import Vehicle
from ev_stack.figures.sheets import Figure
from ev_stack.figures.strokes import strokes_of
from ev_stack.measures.handling import has_spun
from ev_stack.measures.metric import Runs
from ev_stack.recording.recording import Recording, atomic_file
from ev_stack.report.page.first_screen import SHOWN, curve_plots, judged, series_channels
from ev_stack.report.page.parameter_units import unit_of
from ev_stack.report.page.plot_groups import groups_of
from ev_stack.views.car import PREFIX, car_of, view_channels

GAP = 0  # the code of what is not finite; numbers have the codes from 1 on
_LEVEL = 1  # of deflate: higher ones take twice the time for a tenth of the size
# characters of all signals of a page: room for figures below the 15 MB that a page may have
MOST_TEXT = 10_000_000
_PLANES = (3, 2)  # bytes of a sample that are tried, one after the other


class Packed(NamedTuple):
    """A series of `count` numbers: the n-th is low + (code_n - 1) step, a gap where its code is GAP.

    `text` holds the codes: base64 of deflate of `planes` rows of bytes, the lowest byte of every
    code first, of the differences of the codes modulo 256^planes (the first one against 0).
    """

    text: str
    low: float
    step: float
    count: int
    planes: int


def levels(planes: int) -> int:
    """Into how many steps the range of a series is divided."""
    # the code of a gap is none of them, and two are lost where zero is made one of them
    return 256**planes - 4


def pack(values: np.ndarray, planes: int, step: float | None = None) -> Packed:
    """Pack values (n,), rounded to multiples of a step, the range over `levels` unless it is given: zero stays zero."""
    finite = np.isfinite(values)
    held = values[finite]
    low, high = (float(held.min()), float(held.max())) if len(held) else (0.0, 0.0)
    # A given step that would need more codes than there are is dropped for a coarser one.
    if step is None or (high - low) / step > levels(planes):
        step = (high - low) / levels(planes)
    if step > 0.0:
        # Codes count from a multiple of the step, so that zero is one of the numbers.
        low = float(np.floor(low / step)) * step
    codes = np.zeros(len(values), np.int64)
    codes[finite] = (np.rint((held - low) / step) if step > 0.0 else 0) + 1
    # Differences of a smooth signal are small and alike, which deflate finds; codes are not.
    changes = np.diff(codes, prepend=0) & (256**planes - 1)
    # Byte by byte in planes: the high bytes are nearly all zero and shrink to nothing.
    rows = [(changes >> 8 * plane & 255).astype(np.uint8).tobytes() for plane in range(planes)]
    text = base64.b64encode(zlib.compress(b"".join(rows), _LEVEL)).decode()
    return Packed(text, low, step, len(values), planes)


def envelope(run: Recording, every: int) -> Recording:
    """Two samples of each 2 `every`: lowest and highest of every channel, in the order in which they came.

    They stand at the first and the middle instant, so no sample moves by more than 2 `every` of
    them; a gap stays a gap. In the shorter rest at the end, they stand at its first and last
    instant. A run comes back as it is if `every` is 1.
    """
    size = 2 * every
    whole = len(run.time) // size * size
    if every == 1 or not whole:
        return run
    last = sorted({whole, len(run.time) - 1}) if whole < len(run.time) else []
    time = np.concatenate([run.time[:whole:every], run.time[last]])

    def thinned(values: np.ndarray) -> np.ndarray:
        rest = _ends(values[whole:], len(values) - whole)[: len(last)] if last else values[:0]
        return np.concatenate([_ends(values[:whole], size), rest])

    return Recording(time, {name: thinned(values) for name, values in run.channels.items()})


def _ends(values: np.ndarray, size: int) -> np.ndarray:
    bins = values.reshape(-1, size)
    lowest, highest = bins.argmin(axis=1), bins.argmax(axis=1)
    # In the order of time, or a line would go up where the signal goes down.
    places = np.stack([np.minimum(lowest, highest), np.maximum(lowest, highest)], axis=1)
    return np.take_along_axis(bins, places, axis=1).ravel()


@dataclass(frozen=True)
class Signals:
    """The runs of one result; `label` distinguishes results of one page, empty if alone.

    Without the `vehicle` that drove them nothing is seen from above. `units` are those of channels
    that belong to no topic. Runs in which the car has spun do not set the limits of axes; `spun`
    names those that do not hold its motion. `curves` are those of the first screen.
    """

    label: str
    runs: Runs
    vehicle: Vehicle | None
    units: Mapping[str, str] = field(default_factory=dict)
    spun: Collection[str] = ()
    curves: Sequence[str] = ()


@dataclass
class SignalData:
    """Series for the page's script: `index` names blocks, `blocks` are packed series as texts.

    `precision` has in words what packing has taken from the signals.
    """

    index: dict[str, Any] = field(default_factory=dict)
    blocks: list[str] = field(default_factory=list)
    precision: str = ""


def signal_data(results: Sequence[Signals], most_text: int = MOST_TEXT) -> SignalData:
    """Pack all channels of all runs as fine as `most_text` characters hold.

    The steps are 24 bits, 16 bits, and envelopes of these; the coarsest one comes back even if it
    is too long.
    """
    every = 1
    longest = max((len(run.time) for result in results for run in result.runs.values()), default=0)
    # Each round halves the samples of all signals.
    while True:
        # An envelope of twice as many samples as there are would be the whole run again.
        is_thinnest = 4 * every > longest
        # Precision goes before samples: a thinned signal with 24 bits would be no better to see.
        for planes in _PLANES if every == 1 else _PLANES[-1:]:
            data = _packed(results, planes, every)
            if sum(map(len, data.blocks)) <= most_text:
                return data
        if is_thinnest:
            return data
        every *= 2


def _packed(results: Sequence[Signals], planes: int, every: int) -> SignalData:
    places: dict[str, int] = {}

    def placed(packed: Packed) -> dict[str, Any]:
        # Series that are equal, such as the instants of several runs, stand on the page once.
        block = places.setdefault(packed.text, len(places))
        return {
            "block": block,
            **{name: value for name, value in packed._asdict().items() if name != "text"},
        }

    runs = []
    # Results that name other curves are shown by those of the first one.
    curves = next((result.curves for result in results if result.curves), ())
    # Results of one run each, all of the same name, are distinguished by their labels alone.
    are_alike = len({name for result in results for name in result.runs}) == 1
    labels = [_label(result, name, are_alike) for result in results for name in result.runs]
    strokes = strokes_of(labels) if len(labels) > 1 else {}
    for result in results:
        for name, run in result.runs.items():
            car, label = result.vehicle, _label(result, name, are_alike)
            channels = {**run.channels, **series_channels(run, curves)}
            if car:
                channels |= view_channels(run, car)
            thinned = envelope(Recording(run.time, channels), every)
            runs.append(
                {
                    "name": label,
                    "stroke": strokes.get(label.replace("_", " ")),
                    "car": car_of(car) if car else None,
                    "spun": name in result.spun or has_spun(run),
                    "time": placed(pack(thinned.time, planes=3, step=_period(run.time))),
                    "channels": {
                        key: placed(pack(values, planes))
                        for key, values in thinned.channels.items()
                    },
                }
            )
    names = dict.fromkeys(
        key for run in runs for key in run["channels"] if not key.startswith(PREFIX)
    )
    units = {name: unit for result in results for name, unit in result.units.items()}
    groups = groups_of(names, units)
    index = {"runs": runs, "groups": groups, "curves": curve_plots(curves, groups)}
    return SignalData(index, list(places), _precision(planes, every))


def _label(result: Signals, name: str, are_alike: bool) -> str:
    if not result.label:
        return name
    return result.label if are_alike else f"{result.label}: {name}"


def _period(time: np.ndarray) -> float | None:
    """The smallest distance of two instants, of which all are multiples; None for less than two."""
    return float(np.diff(time).min()) if len(time) > 1 else None


def _precision(planes: int, every: int) -> str:
    rounding = f"Samples are rounded to 1/{levels(planes):,} of the range of their channel".replace(
        ",", "\u202f"
    )
    if every == 1:
        return f"{rounding}; every sample is there."
    return (
        f"{rounding}; of {2 * every} samples the lowest and the highest of each channel are there,"
        " for all of them would make the page too large."
    )


def by_result(summaries: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The metrics of all results, one row for each name, values side by side in the order of the results."""
    names = dict.fromkeys(name for summary in summaries.values() for name in summary["metrics"])
    rows = []
    for name in names:
        found = [summary["metrics"].get(name) for summary in summaries.values()]
        # Each name comes from one of the summaries, so there is one.
        first = next(metric for metric in found if metric)
        rows.append({"name": name, "unit": first["unit"], "found": found, "first": first})
    return rows


def measured_signals(
    measured: Mapping[str, Mapping[str, Any]],
    units: Mapping[str, str],
    spun: Collection[str],
    curves: Sequence[str] = (),
) -> tuple[Signals, ...]:
    """Signals measured over `time` on the cases that have them, in these units."""
    series = {name: _series(values) for name, values in measured.items()}
    runs = {name: found for name, found in series.items() if found is not None}
    return (Signals("", runs, None, units, spun, curves),) if runs else ()


def _series(values: Mapping[str, Any]) -> Recording | None:
    # A measurement without time has nothing that could be drawn over it.
    time = values.get(TIME)
    if not isinstance(time, np.ndarray):
        return None
    others = {
        name: np.asarray(each, dtype=np.float64)
        for name, each in values.items()
        if name != TIME and isinstance(each, np.ndarray) and each.shape == time.shape
    }
    return Recording(time, others) if others else None


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
    """Content of a page: `summaries` by label as in summary.json, `table` is text of a study."""

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
        judged=judged(page.summaries),
        data=signal_data(page.signals),
        car={entry.name: entry.spec for entry in entries(Vehicle)},
        unit=unit_of,
    )
    with atomic_file(path) as file:
        file.write(text.encode())


def filled(template: str, **values: Any) -> str:
    """The text of a template with these values, with all styles and scripts that it names."""
    environment = Environment(
        loader=FunctionLoader(_file), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["number"] = _number
    environment.globals["file"] = _file
    environment.globals["SHOWN"] = SHOWN
    environment.globals["CAR_PARAMETERS"] = [entry.name for entry in entries(Vehicle, "vehicle.")]
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
    """The files NAME.png that were saved in a folder.

    What they show are titles and labels of their axes.
    """
    return {
        name: Image((folder / f"{name}.png").read_bytes(), _shown(figure))
        for name, figure in figures.items()
    }


def _shown(figure: Figure) -> str:
    panels = []
    for axes in figure.axes:
        title = axes.get_title(loc="left") or axes.get_title()
        labels = " over ".join(filter(None, (axes.get_ylabel(), axes.get_xlabel())))
        panels.append(": ".join(filter(None, (title, labels))))
    return "; ".join(dict.fromkeys(filter(None, panels)))
