"""Files of an identification: the car with intervals, unknown combinations, before and after.

How it works: start and result are driven side by side on each part of the record. From that follow
the doubts (why no interval is given at all), what became worse, and the table. The number of a
parameter stays in the files in any case; only its interval is left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ev_stack.recording.recording import atomic_file
from ev_stack.report.tables import text_table
from ev_study.measured.free_parameters import FreeParameter, changes
from ev_study.measured.identification import Fitted, floors_of
from ev_study.measured.intervals import Knowledge, in_words
from ev_study.measured.records.record import LONGITUDINAL, quoted_source
from ev_study.measured.replays.errors import CLEAR, Judged
from ev_study.measured.replays.open_loop import COMPARED, OpenLoop
from ev_study.measured.replays.validation import Validation
from ev_study.measured.vehicle_text import parameter_text, vehicle_text

CAR, BESIDE = "vehicle.yaml", "parameters.yaml"
PARTS = ("training", "held out")
# Share of an RMS error above which its mean counts: all windows have it, so their differences do
# not show it.
CONSTANT = 0.5


@dataclass(frozen=True)
class Identified:
    """A fit, its certainty, and the replays of start and result by part of the record.

    `stated` are given values of the vehicle by dotted name, `beside` others by ROLE.PARAMETER.
    `moved` is by input what one per cent of its sensor's scale moves each parameter by,
    (parameters,), empty if it is not wanted.
    """

    free: Sequence[FreeParameter]
    fitted: Fitted
    known: Knowledge
    replays: Mapping[str, OpenLoop]
    stated: Mapping[str, Any]
    beside: Mapping[str, Any]
    command: str
    moved: Mapping[str, np.ndarray] = field(default_factory=dict)

    @cached_property
    def judged(self) -> Mapping[str, tuple[Validation, Validation]]:
        """Validations before and after, by part."""
        # Both cars in one batch, so that they differ by the parameters alone.
        points = np.array([[each.start for each in self.free], self.fitted.values])
        found = {}
        for part, replay in self.replays.items():
            both = replay.simulate(changes(self.free, points, replay.configurations))
            before, after = (
                Validation(replay, {n: v[i] for n, v in both.items()}, 0.0) for i in range(2)
            )
            found[part] = (before, after)
        return found

    @cached_property
    def doubts(self) -> list[str]:
        """Why the fit supports no interval of any parameter, a line each; empty if it does."""
        training, found = self.replays[PARTS[0]], []
        if not self.fitted.converged:
            found.append("the search used all of its --steps and has not come to an optimum")
        if len(training.windows) == 1:
            found.append("one window does not show how much windows differ")
        before, after = self.judged[PARTS[0]]
        floors = floors_of(training, [*self.fitted.weights])
        for name in self.fitted.weights:
            was, now = (each.judged[name] for each in (before, after))
            typical = float(np.nanstd(training.measured(name)))
            # An error of the root of 1 - CLEAR of the signal's own deviation leaves CLEAR of its
            # variance explained. `not` also catches NaN, of a car that has no finite numbers.
            if not now.median_window < (1.0 - CLEAR) ** 0.5 * typical:
                off = (
                    f"the fit is {now.median_window:.3g} {now.unit} off {name} in the median window"
                )
                found.append(
                    f"{off}, which itself deviates by {typical:.3g}: another clock, sensor or car"
                )
            constant = now.errors.bias
            # An offset below the noise of the sensor is no finding, however small the other errors
            # are.
            if abs(constant) > max(CONSTANT * now.errors.rms, floors[name]):
                found.append(
                    f"the fit is {constant:+.3g} {now.unit} off {name} on average: offset of a"
                    " sensor"
                )
            # Where the start was within the weight already, 5 % of that is chance.
            if now.median_window > was.median_window + 0.05 * max(
                was.median_window, self.fitted.weights[name]
            ):
                found.append(f"{name} is reproduced worse than at the start: {_change(was, now)}")
            if late := now.is_late(name):
                found.append(late)
        return found

    def worse(self) -> list[str]:
        """A line for each compared signal that the result reproduces worse than the start did, beside the doubts."""
        lines = []
        for part, (before, after) in self.judged.items():
            for name in before.names:
                # These are among the doubts.
                if part == PARTS[0] and name in self.fitted.weights:
                    continue
                was, now = before.judged[name], after.judged[name]
                if now.median_window > 1.05 * was.median_window:
                    lines.append(
                        f"{part}: {name} is reproduced worse than at the start: {_change(was, now)}"
                    )
        return lines

    def _why_none(self, place: int) -> str:
        """Why a parameter has no interval; empty if it has one."""
        if self.doubts:
            return "no interval, see the notes of the fit"
        each, value = self.free[place], self.fitted.values[place]
        # There the bound has decided, not the record: an interval would end at it by construction.
        at_end = min(value - each.low, each.high - value) < 1e-3 * each.scale
        return "no interval, at the end of its range" if at_end else ""

    @cached_property
    def intervals(self) -> np.ndarray:
        """95 % intervals in the unit of each parameter, (parameters, 2); NaN where the fit supports none."""
        found = self.known.interval.copy()
        for place in range(len(self.free)):
            if self._why_none(place):
                found[place] = np.nan
        return found

    def notes(self) -> list[str]:
        """A line for each parameter: interval and deviation, or why it has none."""
        lines = []
        for place, (each, (low, high)) in enumerate(zip(self.free, self.intervals, strict=True)):
            unit = f" {each.unit}" if each.unit not in ("", "1") else ""
            interval = (
                f"{low:.4g} to {high:.4g}{unit} in 95 %, deviation"
                f" {self.known.deviation[place]:.2g}"
            )
            lines.append(f"{self._why_none(place) or interval}, start {each.start:.6g}")
        return lines

    def table(self) -> str:
        """Parameters, then errors before and after on both parts, then what the record does not determine."""
        rows = []
        for place, (each, value, (low, high)) in enumerate(
            zip(self.free, self.fitted.values, self.intervals, strict=True)
        ):
            known = (f"{low:.4g}", f"{high:.4g}", f"{self.known.deviation[place]:.2g}")
            given = ("-", "-", "-") if self._why_none(place) else known
            moved = (f"{of[len(rows)]:+.2g}" for of in self.moved.values())
            rows.append([each.name, f"{each.start:.6g}", f"{value:.6g}", *given, *moved, each.unit])
        scales = ("1 % of speed" if name == LONGITUDINAL else "1 % of angle" for name in self.moved)
        columns = (
            "parameter",
            "start",
            "identified",
            "2.5 %",
            "97.5 %",
            "deviation",
            *scales,
            "unit",
        )
        errors = [
            [
                part,
                name,
                COMPARED[name],
                *(f"{v:.4g}" for each in both for v in _rms_and_median(each, name)),
                str(int(both[1].spun.sum())),
            ]
            for part, both in self.judged.items()
            for name in both[0].names
        ]
        heads = (
            "part",
            "signal",
            "unit",
            "rms before",
            "median window",
            "rms after",
            "median",
            "windows left",
        )
        unknown = in_words(self.known, self.free)
        lines = [f"not determined by this record: {line}; kept near the start" for line in unknown]
        lines += [f"no interval: {line}" for line in self.doubts]
        # The reason per parameter only where there is no common one, which stands above.
        lines += [
            f"no interval: {each.name} is at the end of its range"
            for place, each in enumerate(self.free)
            if self._why_none(place) and not self.doubts
        ]
        lines += self.worse()
        return "\n".join(
            [
                text_table(columns, rows, ("parameter", "unit")),
                "",
                text_table(heads, errors, heads[:3]),
                *lines,
            ]
        )

    def write(self, folder: Path, page: bool) -> None:
        """The car, the parameters beside it, and the validation on what was held out, with the table above."""
        replay = self.replays[PARTS[0]]
        source = f"identified from {quoted_source(replay.record)}"
        head = [
            (
                f"{source}: {len(replay.windows)} windows of"
                f" {(replay.windows.size - 1) * replay.record.period:g} s"
            ),
            self.command,
            *(f"no interval: {line}" for line in self.doubts),
        ]
        vehicle = replay.configurations["plant"].common.vehicle
        texts = {
            CAR: vehicle_text(
                self.stated, vehicle, self.free, self.fitted.values, self.notes(), head
            ),
            BESIDE: parameter_text(self.beside, self.free, self.fitted.values, self.notes(), head),
        }
        for name, text in texts.items():
            # Nothing beside the car was given or is free: no file.
            if text:
                with atomic_file(folder / name) as file:
                    file.write(text.encode())
        # What the fit has not seen is the validation; a fit to all of the record has only what it
        # has seen.
        part = PARTS[1] if PARTS[1] in self.judged else PARTS[0]
        self.judged[part][1].write(folder, self.command, page, self.as_json(source), self.table())

    def as_json(self, source: str) -> dict[str, Any]:
        """Content of summary.json besides the validation."""
        parameters = {
            each.name: {
                **{
                    "start": each.start,
                    "value": float(value),
                    "interval": None if self._why_none(place) else interval.tolist(),
                    "deviation": None if self._why_none(place) else float(deviation),
                },
                "moved_by_one_per_cent": {
                    channel: float(of[place]) for channel, of in self.moved.items()
                },
                **{"unit": each.unit, "source": source},
            }
            for place, (each, value, interval, deviation) in enumerate(
                zip(
                    self.free, self.fitted.values, self.intervals, self.known.deviation, strict=True
                )
            )
        }
        errors = {
            part: {
                name: dict(
                    zip(
                        ("rms_before", "median_before", "rms_after", "median_after"),
                        numbers,
                        strict=True,
                    )
                )
                for name in both[0].names
                if np.isfinite(
                    numbers := [v for each in both for v in _rms_and_median(each, name)]
                ).all()
            }
            for part, both in self.judged.items()
        }
        left = {part: both[1].begins()[both[1].spun].tolist() for part, both in self.judged.items()}
        return {
            "identified": parameters,
            "before_and_after": errors,
            "windows_left": left,
            "no_interval": self.doubts,
            "worse": self.worse(),
            "cannot_be_told": in_words(self.known, self.free),
            "costs": list(self.fitted.costs),
            "evaluations": self.fitted.evaluations,
        }


def _change(before: Judged, after: Judged) -> str:
    """The RMS errors of the median window, from the one to the other."""
    return (
        f"{before.median_window:.4g} before, {after.median_window:.4g} {before.unit} after, in the"
        " median window"
    )


def _rms_and_median(validation: Validation, name: str) -> tuple[float, float]:
    judged = validation.judged[name]
    return judged.errors.rms, judged.median_window
