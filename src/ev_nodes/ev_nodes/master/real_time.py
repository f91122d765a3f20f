"""The parameters of how time runs, the newest inputs that real time holds, and how well real time was kept."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ev_core.lockstep.holding import HeldInputs
from ev_core.methods.common_parameters import CommonParameters
from ev_core.parameters.declaration import setting
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError

LONGEST = 1e7  # simulated time of a run [s]; a stamp holds 2e9
RECORDER_LAG = 200  # steps that the recorder may be behind; less than topics.QUEUE_DEPTH
_DIGITS = (1.0, 2.0, 5.0)
EDGES = tuple(digit * 10.0**power for power in range(-6, 1) for digit in _DIGITS)  # of bins [s]
_COMMAND = frame.PLACES[WheelTorqueCommand]
_DRIVE = slice(_COMMAND.start, _COMMAND.start + 4)
_BRAKE = slice(_COMMAND.start + 4, _COMMAND.stop)


@dataclass(frozen=True, slots=True)
class MasterParameters:
    """Parameters of how time runs."""

    real_time_factor: float = setting(
        0.0,
        unit="1",
        low=0.0,
        high=1000.0,
        about="simulated over wall time in lockstep, at most; 0: no limit; in real time it is 1",
    )
    duration: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=LONGEST,
        about="the node ends at this time; 0: never",
        read_only=True,
    )
    manoeuvre_end: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=LONGEST,
        about="the manoeuvre is over at this time; 0: not known",
        read_only=True,
    )
    lesson: tuple[str, ...] = setting(
        (), about="parameters, as NODE.NAME, that a live page has beside its plots", read_only=True
    )
    command_timeout: float = setting(
        0.1,
        unit="s",
        low=0.001,
        high=60.0,
        about="realtime: age of a torque command at which no torque is left of it",
    )
    command_ramp: float = setting(
        0.02,
        unit="s",
        low=0.0,
        high=60.0,
        about="realtime: time before that over which its torque falls to zero",
    )
    command_loss_brake_torque: float = setting(
        0.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="realtime: at each wheel in place of what is lost; 0: it coasts",
    )
    answer_timeout: float = setting(
        2.0,
        unit="s",
        low=0.1,
        high=3600.0,
        about="wall time without an answer after which the silent nodes are named",
    )
    await_recorder: bool = setting(
        False,
        about=f"stay within {RECORDER_LAG} steps of the recorder, so that it misses nothing",
        read_only=True,
    )

    def refuse_beside(self, common: CommonParameters) -> None:
        """ParameterError if they do not fit to those that every node has."""
        if common.mode != "realtime":
            return
        if self.real_time_factor not in (0.0, 1.0):
            name = "real_time_factor"
            raise ParameterError(
                f"parameter {name}: {self.real_time_factor:g} is refused, expected 1 in real time,"
                " or mode lockstep",
                name,
            )
        periods = 2.0 * common.control_period
        if self.command_timeout <= periods:
            allowed = f"more than two control periods, {periods:g} s"
            name = "command_timeout"
            raise ParameterError(
                f"parameter {name}: {self.command_timeout:g} is refused, expected {allowed}", name
            )
        # In whole nanoseconds: 0.04 s - 0.02 s is not 0.02 s in floats.
        most = stamps.from_seconds(self.command_timeout) - stamps.from_seconds(periods)
        if stamps.from_seconds(self.command_ramp) > most:
            allowed = (
                f"at most command_timeout less two control periods, {stamps.to_seconds(most):g} s"
            )
            name = "command_ramp"
            raise ParameterError(
                f"parameter {name}: {self.command_ramp:g} is refused, expected {allowed}, or the"
                " torque of every command has faded in part",
                name,
            )


class FadingInputs(HeldInputs):
    """The newest inputs, of which the torque command fades with its age."""

    _command_came = 0.0

    def take(self, kind: type, stamp: int, numbers: Sequence[float], limit: int) -> bool:
        """Keep a message.

        It returns False if its stamp is not above the last one of its kind, or is above the limit.
        """
        if not self.stamp_of(kind) < stamp <= limit:
            return False
        self.keep(kind, stamp, numbers)
        if kind is WheelTorqueCommand:
            self.came_now()
        return True

    def came_now(self) -> None:
        """Count the age of the torque command by the wall clock from now on."""
        self._command_came = time.monotonic()

    def share(self, now: int, period: int, p: MasterParameters) -> float:
        """Share of the held torque command [1] that acts in the step from now on.

        It falls to zero by a ramp. No torque acts any more when the command is `command_timeout`
        old. So its age at the end of the step counts, by its stamp or by the wall clock, whichever
        is more.
        """
        by_stamp = now - self.stamp_of(WheelTorqueCommand)
        by_wall_clock = stamps.from_seconds(time.monotonic() - self._command_came)
        # In whole nanoseconds: 0.1 s - 0.09 s - 0.01 s is above zero in floats, which without a
        # ramp is all torque.
        left = stamps.from_seconds(p.command_timeout) - max(by_stamp, by_wall_clock) - period
        if left <= 0:
            return 0.0
        return min(stamps.to_seconds(left) / p.command_ramp, 1.0) if p.command_ramp > 0.0 else 1.0

    def at(self, share: float, brake_torque: float) -> Frame:
        """The inputs of a step; brake torque replaces the share of the command that has faded."""
        here = Frame()
        here.numbers[:] = self.frame.numbers
        if share < 1.0:
            numbers = here.numbers
            numbers[_DRIVE] = frame.numbers_of([share * torque for torque in numbers[_DRIVE]])
            brake = (1.0 - share) * brake_torque
            numbers[_BRAKE] = frame.numbers_of(
                [share * torque + brake for torque in numbers[_BRAKE]]
            )
        return here


class Histogram:
    """Counts times [s] in three bins a decade from 1 us to 5 s and above.

    Shorter times are in the first.
    """

    def __init__(self) -> None:
        self.counts = [0] * (len(EDGES) + 1)
        self.largest = 0.0

    def add(self, seconds: float) -> None:
        """Count a time."""
        self.counts[bisect_right(EDGES, seconds)] += 1
        if seconds > self.largest:
            self.largest = seconds

    def as_json(self) -> dict[str, Any]:
        """Lower ends of the bins but the first [s], counts of all, and the largest time [s]."""
        return {"edges": list(EDGES), "counts": self.counts, "largest": self.largest}


class Timing:
    """Wall times of a run in real time, all by the monotonic clock.

    `period` is the time between steps, `lateness` the time from when a step was due until it was
    taken, `arrival` by topic the time from when an instant was due until its input came. An overrun
    is a step that was more than a period late. `without_command` counts the steps with faded
    torque because no command was new enough, `refused` by topic the inputs that were older than
    others before, or of instants that have yet to come.
    """

    def __init__(self, reads: tuple[type, ...]) -> None:
        self.steps = self.overruns = self.without_command = 0
        self.period, self.lateness = Histogram(), Histogram()
        self.arrival = {kind: Histogram() for kind in reads}
        self.refused = dict.fromkeys(reads, 0)
        self._stepped: float | None = None

    def stepped(self, lateness: float) -> None:
        """Count a step that was taken now."""
        now = time.monotonic()
        if self._stepped is not None:
            self.period.add(now - self._stepped)
        self._stepped = now
        self.steps += 1
        self.lateness.add(lateness)

    def rested(self) -> None:
        """Note that time stood still until now: the pause is no period between steps."""
        self._stepped = None

    def as_json(self) -> dict[str, Any]:
        """All of it; times in seconds."""
        return {
            "steps": self.steps,
            "overruns": self.overruns,
            "without_command": self.without_command,
            "refused": {TOPICS[kind].name: count for kind, count in self.refused.items()},
            "period": self.period.as_json(),
            "lateness": self.lateness.as_json(),
            "arrival": {
                TOPICS[kind].name: histogram.as_json() for kind, histogram in self.arrival.items()
            },
        }
