"""From the results of one or several commands to what the templates of a page are filled with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.page.codec import Packed, levels, pack
from ev_sim.report.page.envelope import envelope
from ev_sim.report.page.quantities import groups_of
from ev_sim.report.page.top_view import PREFIX, car_of, view_channels
from ev_sim.report.samples import Runs
from ev_sim.running.recording.recording import Recording

MOST_TEXT = 10_000_000  # characters of all signals of a page: room for figures below the 15 MB that a page may have
_PLANES = (3, 2)  # bytes of a sample that are tried, one after the other


@dataclass(frozen=True)
class Signals:
    """The runs of one result; `label` tells results of one page apart, empty if alone.

    Without the `vehicle` that drove them nothing is seen from above.
    """

    label: str
    runs: Runs
    vehicle: Vehicle | None


@dataclass
class SignalData:
    """What the page's script draws: `index` names blocks, `blocks` are the texts of packed series.

    `precision` says in words what packing has taken from the signals.
    """

    index: dict[str, Any] = field(default_factory=dict)
    blocks: list[str] = field(default_factory=list)
    precision: str = ""


def signal_data(results: Sequence[Signals], most_text: int = MOST_TEXT) -> SignalData:
    """All channels of all runs as fine as `most_text` characters hold: 24 bits, 16 bits, or an envelope of these."""
    every = 1
    while True:
        for planes in _PLANES if every == 1 else _PLANES[-1:]:
            data = _packed(results, planes, every)
            if sum(map(len, data.blocks)) <= most_text:
                return data
        every *= 2


def _packed(results: Sequence[Signals], planes: int, every: int) -> SignalData:
    places: dict[str, int] = {}

    def placed(packed: Packed) -> dict[str, Any]:
        block = places.setdefault(packed.text, len(places))
        return {
            "block": block, "low": packed.low, "step": packed.step, "count": packed.count, "planes": packed.planes
        }  # fmt: skip

    runs = []
    for result in results:
        for name, run in result.runs.items():
            car = result.vehicle
            channels = {**run.channels, **(view_channels(run, car) if car else {})}
            thinned = envelope(Recording(run.time, channels), every)
            runs.append(
                {
                    "name": f"{result.label}: {name}" if result.label else name,
                    "car": car_of(car) if car else None,
                    "time": placed(pack(thinned.time, planes=3, step=_period(run.time))),
                    "channels": {key: placed(pack(values, planes)) for key, values in thinned.channels.items()},
                }
            )
    names = dict.fromkeys(key for run in runs for key in run["channels"] if not key.startswith(PREFIX))
    return SignalData({"runs": runs, "groups": groups_of(names)}, list(places), _precision(planes, every))


def _period(time: np.ndarray) -> float | None:
    """The smallest distance of two instants, of which all are multiples; None for less than two."""
    return float(np.diff(time).min()) if len(time) > 1 else None


def _precision(planes: int, every: int) -> str:
    rounding = f"Samples are rounded to 1/{levels(planes):,} of the range of their channel".replace(",", "\u202f")
    if every == 1:
        return f"{rounding}; every sample is there."
    return (
        f"{rounding}; of {2 * every} samples the lowest and the highest of each channel are there, for all of them "
        "would make the page too large."
    )


def by_result(summaries: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The metrics of all results, one row for each name, values side by side in the order of the results."""
    names = dict.fromkeys(name for summary in summaries.values() for name in summary["metrics"])
    rows = []
    for name in names:
        found = [summary["metrics"].get(name) for summary in summaries.values()]
        told = next(metric for metric in found if metric)
        rows.append({"name": name, "unit": told["unit"], "found": found, "told": told})
    return rows
