"""What an identification leaves behind: the car with intervals, what the record cannot tell, before and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ev_sim.measured.free_parameters import FreeParameter, changes
from ev_sim.measured.identification import Fitted
from ev_sim.measured.intervals import Knowledge, in_words
from ev_sim.measured.records.record import quoted_source
from ev_sim.measured.replays.open_loop import COMPARED, OpenLoop
from ev_sim.measured.replays.validation import FILES, Validation
from ev_sim.measured.vehicle_text import parameter_text, vehicle_text
from ev_sim.recording.recording import atomic_file
from ev_sim.report.tables import text_table

CAR, BESIDE = "vehicle.yaml", "parameters.yaml"
FILES_OF_IDENTIFICATION = (*FILES, CAR, BESIDE)
PARTS = ("training", "held out")


@dataclass(frozen=True)
class Identified:
    """A fit, what it knows, and by part of the record the replays of start and result.

    `stated` is what was given of the vehicle by dotted name, `beside` what else by ROLE.PARAMETER.
    """

    free: Sequence[FreeParameter]
    fitted: Fitted
    known: Knowledge
    replays: Mapping[str, OpenLoop]
    stated: Mapping[str, Any]
    beside: Mapping[str, Any]
    command: str

    @cached_property
    def judged(self) -> Mapping[str, tuple[Validation, Validation]]:
        """By part before and after."""
        points = np.array([[each.start for each in self.free], self.fitted.values])
        found = {}
        for part, replay in self.replays.items():
            both = replay.simulate(changes(self.free, points, replay.configurations))
            before, after = (Validation(replay, {n: v[i] for n, v in both.items()}, 0.0) for i in range(2))
            found[part] = (before, after)
        return found

    def notes(self) -> list[str]:
        """By parameter in one line: interval and deviation."""
        lines = []
        for each, (low, high), deviation, value in zip(
            self.free, self.known.interval, self.known.deviation, self.fitted.values, strict=True
        ):
            at_end = min(value - each.low, each.high - value) < 1e-3 * each.scale
            end = ", at the end of its range" if at_end else ""
            unit = f" {each.unit}" if each.unit not in ("", "1") else ""
            lines.append(
                f"{low:.4g} to {high:.4g}{unit} in 95 %, deviation {deviation:.2g}, start {each.start:.6g}{end}"
            )
        return lines

    def table(self) -> str:
        """Parameters, then errors before and after on both parts, then what the record does not determine."""
        rows = [
            [each.name, f"{each.start:.6g}", f"{value:.6g}", f"{low:.4g}", f"{high:.4g}", f"{deviation:.2g}", each.unit]
            for each, value, (low, high), deviation in zip(
                self.free, self.fitted.values, self.known.interval, self.known.deviation, strict=True
            )
        ]
        columns = ("parameter", "start", "identified", "2.5 %", "97.5 %", "deviation", "unit")
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
        heads = ("part", "signal", "unit", "rms before", "median window", "rms after", "median", "windows left")
        unknown = in_words(self.known, self.free)
        lines = [f"not determined by this record: {line}; kept near the start" for line in unknown]
        return "\n".join(
            [text_table(columns, rows, ("parameter", "unit")), "", text_table(heads, errors, heads[:3]), *lines]
        )

    def write(self, folder: Path, page: bool) -> None:
        """The car, the parameters beside it, and the validation on what was held out, with the table above."""
        replay = self.replays[PARTS[0]]
        source = f"identified from {quoted_source(replay.record)}"
        head = [
            f"{source}: {len(replay.windows)} windows of {(replay.windows.size - 1) * replay.record.period:g} s",
            self.command,
        ]
        vehicle = replay.configurations["plant"].common.vehicle
        texts = {
            CAR: vehicle_text(self.stated, vehicle, self.free, self.fitted.values, self.notes(), head),
            BESIDE: parameter_text(self.beside, self.free, self.fitted.values, self.notes(), head),
        }
        for name, text in texts.items():
            if text:
                with atomic_file(folder / name) as file:
                    file.write(text.encode())
        part = PARTS[1] if PARTS[1] in self.judged else PARTS[0]
        self.judged[part][1].write(folder, self.command, page, self.as_json(source), self.table())

    def as_json(self, source: str) -> dict[str, Any]:
        """What summary.json has besides the validation."""
        parameters = {
            each.name: {
                **{
                    "start": each.start,
                    "value": float(value),
                    "interval": interval.tolist(),
                    "deviation": float(deviation),
                },
                **{"unit": each.unit, "source": source},
            }
            for each, value, interval, deviation in zip(
                self.free, self.fitted.values, self.known.interval, self.known.deviation, strict=True
            )
        }
        errors = {
            part: {
                name: dict(zip(("rms_before", "median_before", "rms_after", "median_after"), numbers, strict=True))
                for name in both[0].names
                if np.isfinite(numbers := [v for each in both for v in _rms_and_median(each, name)]).all()
            }
            for part, both in self.judged.items()
        }
        left = {part: both[1].begins()[both[1].spun].tolist() for part, both in self.judged.items()}
        return {
            "identified": parameters,
            "before_and_after": errors,
            "windows_left": left,
            "cannot_be_told": in_words(self.known, self.free),
            "costs": list(self.fitted.costs),
            "evaluations": self.fitted.evaluations,
        }


def _rms_and_median(validation: Validation, name: str) -> tuple[float, float]:
    judged = validation.judged[name]
    return judged.errors.rms, judged.median_window
