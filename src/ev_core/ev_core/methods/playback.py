"""Roles that are played by recorded signals.

A recording is named by its path: `driver=results/shchur2019/latest/signals.npz`.

How it works: the numbers of the role's signals are one row for each recorded instant. A step copies
the row of its instant into the frame. So the recording has to have the control period of the run,
and ends it where it ends itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.methods.law import NoParameters
from ev_core.methods.method_record import Method
from ev_core.methods.part import CalledBack
from ev_core.parameters.data_file import TIME, RecordingError, read_arrays, refuse_outside
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.fields import NEGLIGIBLE, SignalError, shape_of
from ev_msgs_py.contract.frame import PLACES, Frame, time_in
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError


@dataclass(frozen=True, slots=True)
class Playback(Method):
    """A method with recorded outputs.

    It waits for the inputs of its role that were recorded too, so that no node of the graph is left
    behind.
    """

    @property
    def inputs(self) -> tuple[type, ...]:
        """The signals that a step waits for."""
        return self.reads


def playback_method(role: str, name: str) -> Method:
    """The method of a role that the recording of this path makes.

    ParameterError, in one line, if it cannot.
    """
    path = Path(name)
    try:
        refuse_outside(name, path)
        recorded = _read_once(role, name, path.absolute(), path.stat().st_mtime_ns)
    except OSError as error:
        raise ParameterError(f"{role} method {name}: {error.strerror}", "method") from None
    except RecordingError as error:
        raise ParameterError(f"{role} method: {error}", "method") from None
    reads = tuple(signal for signal in ROLES[role].reads if recorded.has(signal))
    return Playback(role, name, recorded, reads, NoParameters)


@lru_cache(maxsize=8)  # the roles of one recording
def _read_once(role: str, name: str, _path: Path, _modified: int) -> RecordedRole:
    return RecordedRole(role, name, read_arrays(name))


class RecordedRole:
    """The recorded output of a role, instant by instant; makes the objects that repeat it.

    `writes` are the signals of the role that the file has. ParameterError if there is none of them.
    """

    parameters = NoParameters

    def __init__(self, role: str, name: str, arrays: dict[str, np.ndarray]) -> None:
        """Play back what was recorded."""
        self.__doc__ = f"Replay the recorded output of {name}."
        self._names = frozenset(arrays)
        self.role, self.name = role, name
        self.writes = tuple(signal for signal in ROLES[role].may_write if self.has(signal))
        if TIME not in arrays or not self.writes:
            topics = ", ".join(TOPICS[signal].name for signal in ROLES[role].writes)
            raise ParameterError(
                f"{role} method {name}: a {role} writes {topics}, none of it is in the file",
                "method",
            )
        self.stamps = self._stamps(arrays[TIME])
        self.last = int(self.stamps[-1])
        self.instants = len(self.stamps)
        self.rows = [(PLACES[signal], self._rows(arrays, signal)) for signal in self.writes]

    def _stamps(self, times: np.ndarray) -> np.ndarray:
        """The recorded instants [ns]; ParameterError if there are none, or if one is no number."""
        if not len(times):
            raise ParameterError(
                f"{self.role} method {self.name}: the file has no instants, expected one or more"
            )
        self._refuse_not_finite(TIME, times)
        found: np.ndarray = np.rint(times.astype(float) * stamps.NANOSECONDS).astype(np.int64)
        return found

    def _rows(self, arrays: dict[str, np.ndarray], signal: type) -> np.ndarray:
        """The recorded numbers of a signal, (instants, numbers).

        ParameterError if a channel has more or fewer. So it is if one is not finite, or if a
        command is negative, such as a brake torque.
        """
        channels = TOPICS[signal].channels
        for channel in channels:
            if len(arrays[channel]) != self.instants:
                raise ParameterError(
                    f"{self.role} method {self.name}: {channel} has {len(arrays[channel])} "
                    f"numbers, {TIME} has {self.instants}, expected as many"
                )
            self._refuse_not_finite(channel, arrays[channel])
        rows = np.stack([arrays[channel].astype(float) for channel in channels], axis=1)
        for place in shape_of(signal).unsigned_commands:
            column = rows[:, place]
            if (column < -NEGLIGIBLE).any():
                at = int(np.argmax(column < -NEGLIGIBLE))
                raise ParameterError(
                    f"{self.role} method {self.name}: {channels[place]} {at} is {column[at]}, "
                    "expected 0 or more"
                )
            # Negative by rounding alone, as a running part would write 0.
            column[column < 0.0] = 0.0
        return rows

    def _refuse_not_finite(self, name: str, values: np.ndarray) -> None:
        if not np.isfinite(values).all():
            at = int(np.argmin(np.isfinite(values)))
            raise ParameterError(
                f"{self.role} method {self.name}: {name} {at} is {values[at]}, expected a finite "
                "number"
            )

    def has(self, signal: type) -> bool:
        """Return whether all channels of a signal were recorded."""
        topic = TOPICS.get(signal)
        return topic is not None and self._names.issuperset(topic.channels)

    def __call__(self, parameters: Any, vehicle: Any, period: float) -> RecordedRole:
        """Itself, for nothing lasts between steps.

        ParameterError if it was recorded with another period.
        """
        expected = np.arange(self.instants) * stamps.from_seconds(period)
        wrong = self.stamps != expected
        if not wrong.any():
            return self
        label = f"{self.role} method {self.name}"
        # Where the last instant is right, some within are not: a recording with a gap.
        if self.stamps[-1] == expected[-1]:
            at = int(np.argmax(wrong))
            raise ParameterError(
                f"{label}: {TIME} {at} is {stamps.to_seconds(int(self.stamps[at])):g} s, "
                f"expected {at * period:g} s: the instants follow each other by the control_period "
                f"of {period:g} s"
            )
        raise ParameterError(
            f"{label}: {self.instants} instants up to {stamps.to_seconds(self.last):g} s "
            f"are none of a control_period of {period:g} s"
        )

    def part(self, method: Method, made: RecordedRole) -> PlaybackPart:
        """The part that plays a role by it."""
        return PlaybackPart(made)


class PlaybackPart(CalledBack):
    """Writes the recorded numbers of an instant into its frame."""

    state = None

    def __init__(self, recorded: RecordedRole) -> None:
        self._recorded = recorded
        self._rows = [
            (place, rows.shape[1], rows.reshape(-1).data) for place, rows in recorded.rows
        ]
        self._period = max(recorded.last // max(recorded.instants - 1, 1), 1)
        self._ahead = int(ROLES[recorded.role].kind is RoleKind.INTEGRATES)

    def start(self, there: Frame) -> None:
        """Write what was recorded at the instant of the frame."""
        self._write(self._step_of(there), there)

    def step(self, here: Frame, there: Frame) -> None:
        """Write what was recorded at this instant, or of a role that integrates at the next one."""
        self._write(self._step_of(here) + self._ahead, there)

    def refuse_not_finite(self, there: Frame) -> None:
        """SignalError if a number that sensors and faults have made of it is not finite."""
        for signal in self._recorded.writes:
            shape_of(signal).refuse_not_finite(there.numbers[PLACES[signal]])

    def notes(self) -> tuple[str, ...]:
        """A recording notes nothing."""
        return ()

    def _step_of(self, now: Frame) -> int:
        return stamps.from_seconds(time_in(now.numbers)) // self._period

    def _write(self, step: int, there: Frame) -> None:
        last = self._recorded.instants - 1
        if step > last:
            if step > last + self._ahead:
                end = stamps.to_seconds(self._recorded.last)
                raise SignalError(
                    f"{self._recorded.name} ends at {end:g} s: it has no numbers of a later time"
                )
            # A role that integrates has an output behind the end, to which no step leads.
            step = last
        for place, width, rows in self._rows:
            there.numbers[place] = rows[step * width : (step + 1) * width]
