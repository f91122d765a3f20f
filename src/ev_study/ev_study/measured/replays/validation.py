"""A car held against a record: errors of its open-loop replay in numbers, and where and why they are worst.

How it works: the replay gives signals of all windows. Everything else is derived from them when it
is asked for and kept: errors by signal, range and window, corridors, the windows that left the
record, figures. Arrays are (windows, samples) throughout; figures set window behind window.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.parameters.declaration import flatten
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.figures.panels import IN_FIGURES, Curve, Panel, readable
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import Sheet, drawn
from ev_stack.measures.metric import Metric
from ev_stack.recording.recording import PAGE, SIGNALS, SUMMARY, Recording, save
from ev_stack.report.page.writing import Page, Signals, images_of, write_page
from ev_stack.report.summary import Summary, write_summary
from ev_study.measured.records.record import (
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    SLOWEST,
    YAW_RATE,
    quoted_source,
)
from ev_study.measured.replays.corridors import (
    Corridor,
    CorridorParameters,
    corridor_sheet,
    corridor_table,
    corridors_of,
)
from ev_study.measured.replays.errors import Judged, error_table, judged, spins
from ev_study.measured.replays.estimates import Estimate
from ev_study.measured.replays.open_loop import COMPARED, OpenLoop
from ev_study.measured.replays.plausibility import contradictions

_FORCES = [
    f"tire_forces.{kind}.{wheel}"
    for kind in ("longitudinal_force", "lateral_force", "load")
    for wheel in WHEEL_NAMES
]
_EFFORT = "wheel_states.effort."
_SHOWN = 3  # windows of which the worst are drawn, with what the tyres do there


@dataclass(frozen=True)
class Validation:
    """A replay that was driven: what it was given, and its signals by name, (windows, samples)."""

    replay: OpenLoop
    simulated: Mapping[str, np.ndarray]
    wall_time: float
    tolerances: CorridorParameters = field(default_factory=CorridorParameters)
    estimates: Sequence[Estimate] = ()

    @property
    def names(self) -> list[str]:
        """The signals of the record that are compared."""
        return self.replay.compared

    @property
    def acceleration(self) -> np.ndarray:
        """Speed times measured yaw rate, as imposed [m/s^2], (windows, samples)."""
        return self.replay.measured(LONGITUDINAL) * self.replay.measured(YAW_RATE)

    @cached_property
    def judged(self) -> Mapping[str, Judged]:
        """Errors against the record, by signal."""
        period, acceleration = self.replay.record.period, self.acceleration
        return {
            n: judged(COMPARED[n], self.simulated[n], self.replay.measured(n), acceleration, period)
            for n in self.names
        }

    @cached_property
    def corridors(self) -> Mapping[str, Corridor]:
        """The corridors around what was simulated, by what lies in them."""
        return corridors_of(self.replay, self.simulated, self.tolerances)

    @cached_property
    def spun(self) -> np.ndarray:
        """Mask of the windows that left the record (`errors.spins`)."""
        simulated = self.simulated[SIDESLIP]
        # Without a measured angle a large one is judged against zero, but only where the car moves.
        known = SIDESLIP in self.replay.record.channels
        if known:
            return spins(simulated, self.replay.measured(SIDESLIP))
        moves = np.abs(self.replay.measured(LONGITUDINAL)) >= SLOWEST
        return spins(simulated, np.where(moves, 0.0, np.nan))

    @cached_property
    def friction_used(self) -> np.ndarray:
        """Horizontal force over load of each wheel [1], (4, windows, samples).

        0 for a lifted one.
        """
        # Four wheels of each kind, in the order of `_FORCES`.
        along, across, load = (
            np.array([self.simulated[f] for f in _FORCES[n : n + 4]]) for n in (0, 4, 8)
        )
        # Below 1 N of load the ratio is noise of a wheel in the air.
        return np.hypot(along, across) / np.where(load > 1.0, load, np.inf)

    def begins(self) -> np.ndarray:
        """When the windows begin, in the time of the file [s]."""
        return self.replay.record.time[self.replay.windows.first]

    def notes(self) -> tuple[str, ...]:
        """Notes on masks and inputs, and on the windows that left the record, with why."""
        record = self.replay.record
        found = [
            *record.notes,
            *self.replay.notes,
            *contradictions(self.replay),
            *self._not_followed(),
        ]
        found += [line for name, each in self.judged.items() if (line := each.is_late(name))]
        for window in np.flatnonzero(self.spun):
            used = self.friction_used[:, window].mean(axis=1)
            # A window with no finite number leaves the record by that, whatever wheel is named.
            wheel = int(np.nanargmax(used)) if np.isfinite(used).any() else 0
            speed = self.replay.measured(LONGITUDINAL)[window]
            found.append(
                f"the window from {self.begins()[window]:.2f} s leaves the record at"
                f" {speed.min():.0f} to {speed.max():.0f} m/s: {WHEEL_NAMES[wheel]} uses"
                f" {used[wheel]:.2f} of its load on average"
            )
        return tuple(found)

    def _not_followed(self) -> list[str]:
        """Note on drives with lag, limits and losses that miss their measured torques."""
        wheels = self.replay.driven_one_by_one
        if not wheels:
            return []
        rms = [
            float(np.sqrt(np.nanmean((self.simulated[_EFFORT + w] - asked) ** 2)))
            for w, asked in wheels.items()
        ]
        each = ", ".join(f"{w} {r:.3g} N m" for w, r in zip(wheels, rms, strict=True))
        return [f"RMS of what the simulated drives do not follow of the measured torques: {each}"]

    def table(self) -> str:
        """Table for the terminal: errors by signal and range, of estimators, and corridors."""
        estimated = {f"{e.name}: {e.channel}": e.judged for e in self.estimates}
        return f"{error_table({**self.judged, **estimated})}\n\n{corridor_table(self.corridors)}"

    def metrics(self) -> dict[str, Metric]:
        """Metrics for summary.json and the page."""
        found: dict[str, Metric] = {}
        for name, each in self.judged.items():
            found |= each.metrics(name)
        for estimate in self.estimates:
            found |= estimate.judged.metrics(f"{estimate.name}_{estimate.channel}")
        for name, corridor in self.corridors.items():
            found[f"{name}_in_corridor"] = corridor.metric
        return found | {
            "windows": Metric(float(len(self.spun)), "1"),
            "windows_left": Metric(float(self.spun.sum()), "1"),
        }

    def recordings(self) -> dict[str, Recording]:
        """Measured and simulated, window behind window.

        An instant that two windows share is that of the later one.
        """
        record, windows = self.replay.record, self.replay.windows
        time = windows.of(record.time)
        # An instant on which two windows meet is in both: the one of the later begins from the
        # record. In front of a gap no other window has the last instant.
        meets_next = np.append(np.diff(windows.first) < windows.size, False)
        keep = np.ones(time.shape, bool)
        keep[meets_next, -1] = False
        keep = keep.ravel()
        measured = {n: windows.of(v).ravel()[keep] for n, v in record.channels.items()}
        simulated = {n: v.ravel()[keep] for n, v in self.simulated.items()}
        return {
            "measured": Recording(time.ravel()[keep], measured),
            "simulated": Recording(time.ravel()[keep], simulated),
        }

    def figures(self) -> dict[str, Sheet]:
        """All windows over time, and the worst ones with the friction that they use."""
        both = self.recordings()
        time = both["measured"].time
        panels = []
        for name in self.names:
            one, other = both["measured"].channels[name], both["simulated"].channels[name]
            # By the measured signal: a window that spins would else set the scale of the figure.
            span = float(np.nanmax(np.abs(one))) * 1.3
            panels.append(
                _panel(readable(name), name, time, {"measured": one, "simulated": other}, span)
            )
            panels.append(_panel(f"error of {readable(name)}", name, time, {"": other - one}, span))
        sheets = {
            "over_time": Sheet(panels),
            "worst": self._worst(),
            "corridors": corridor_sheet(self.corridors),
        }
        if self.estimates:
            sheets["estimates"] = Sheet(
                [panel for each in self.estimates for panel in self._estimated(each)]
            )
        return sheets

    def _estimated(self, estimate: Estimate) -> list[Panel]:
        """Beside what was measured, and how far it is off, window behind window."""
        time, found, measured = (
            x.ravel()
            for x in (
                self.replay.windows.of(self.replay.record.time),
                estimate.values,
                self.replay.measured(estimate.channel),
            )
        )
        title, span = f"{readable(estimate.name)}", float(np.nanmax(np.abs(measured))) * 1.3
        both = {"measured": measured, "estimated": found}
        return [
            _panel(title, estimate.channel, time, both, span),
            _panel(f"error of {title}", estimate.channel, time, {"": found - measured}, span),
        ]

    def _worst(self) -> Sheet:
        # A window without finite numbers is the worst.
        order = np.argsort(np.nan_to_num(self.judged[YAW_RATE].of_windows, nan=np.inf))[::-1][
            :_SHOWN
        ]
        panels = []
        for window in order:
            begin = self.begins()[window]
            time = np.arange(self.replay.windows.size) * self.replay.record.period
            for name in [n for n in (YAW_RATE, SIDESLIP) if n in self.names]:
                both = {
                    "measured": self.replay.measured(name)[window],
                    "simulated": self.simulated[name][window],
                }
                panels.append(_panel(f"{readable(name)} from {begin:.1f} s", name, time, both))
            used = [
                Curve(time, self.friction_used[i, window], readable(w))
                for i, w in enumerate(WHEEL_NAMES)
            ]
            panels.append(Panel("friction used", "force over load [1]", used))
        return Sheet(panels, "time in the window [s]", columns=3)

    def write(
        self,
        folder: Path,
        command: str,
        page: bool,
        more: Mapping[str, Any] | None = None,
        table: str = "",
    ) -> None:
        """Into a folder: summary.json, signals.npz of the simulated car, and with the `page` its figures.

        `more` goes into summary.json, a `table` above that of the errors on the page.
        """
        both = self.recordings()
        configurations = self.replay.configurations
        content = Summary(
            scenario=f"open-loop replay of {quoted_source(self.replay.record)}",
            mode="offline",
            seed=0,
            methods={role: each.method.name for role, each in configurations.items()},
            parameters={role: each.values() for role, each in configurations.items()},
            vehicle=configurations["plant"].common.vehicle,
            runs=both,
            metrics=self.metrics(),
            wall_time=self.wall_time,
            notes=self.notes(),
            about="driven as measured, all else simulated from the measured state on",
            command=command,
        ).as_json()
        # What differs from a scenario's file: there is none.
        del content["differs"]
        of = {name: each.as_json() for name, each in self.judged.items()}
        content |= {
            what: {name: each[what] for name, each in of.items()} for what in ("errors", "by_range")
        }
        content |= {
            "by_window": {
                "begin": self.begins().tolist(),
                **{n: each["by_window"] for n, each in of.items()},
            }
        }
        content |= {"corridors": {name: each.as_json() for name, each in self.corridors.items()}}
        content |= {"corridor_parameters": flatten(self.tolerances)}
        content |= {"estimators": {each.name: each.as_json() for each in self.estimates}}
        write_summary(folder / SUMMARY, content | dict(more or {}))
        # The simulated car alone: what was measured is in the user's own file.
        save(both["simulated"], folder / SIGNALS)
        if page:
            figures = drawn(self.figures())
            save_figures(figures, folder)
            signals = Signals("", both, None)
            shown = "\n\n".join(filter(None, (table, self.table())))
            title = (
                f"{configurations['plant'].common.vehicle.name} against"
                f" {Path(self.replay.record.source).name}"
            )
            write_page(
                Page(title, {"": content}, (signals,), images_of(figures, folder), shown),
                folder / PAGE,
            )


def _panel(
    title: str,
    signal: str,
    time: np.ndarray,
    values: Mapping[str, np.ndarray],
    span: float = np.inf,
) -> Panel:
    """A signal by label over time, in the unit of figures.

    A curve may leave the panel beyond the span.
    """
    unit, factor = IN_FIGURES.get(COMPARED[signal], (COMPARED[signal], 1.0))
    curves = [Curve(time, factor * each, label) for label, each in values.items()]
    return Panel(
        title, f"{readable(signal)} [{unit}]", curves, within=(-factor * span, factor * span)
    )


def signals_to_show() -> Sequence[str]:
    """Signals that a validation has to simulate."""
    return (
        # The sideslip angle is no channel: it follows from the velocities.
        [n for n in COMPARED if n != SIDESLIP]
        + [ROAD_WHEEL_ANGLE]
        + _FORCES
        + [_EFFORT + wheel for wheel in WHEEL_NAMES]
    )
