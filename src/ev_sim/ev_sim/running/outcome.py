"""What driving one run of a scenario gives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ev_sim.running.recording.recording import Recording
from ev_sim.running.scenarios.scenario import Run

if TYPE_CHECKING:
    from ev_sim.running.told import Told

Progress = Callable[[float], None]  # is told the simulated time now and then


class RunFailed(RuntimeError):
    """A run did not come to its end; the message is one line for the user."""


@dataclass(frozen=True)
class Outcome:
    """The signals of a run, the wall time of driving [s], why it may not be reproducible, and what nodes noted.

    `timing` is how well real time was kept (`nodes/timing.py`), empty of a run in lockstep.
    """

    recording: Recording
    wall_time: float
    not_reproducible: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    timing: Mapping[str, Any] = field(default_factory=dict)


def not_reproducible(run: Run, told: Told, recording: Recording) -> tuple[str, ...]:
    """Why a run that was driven over DDS may not give the same numbers again."""
    return (*(["driven by the wall clock"] if run.realtime else []), *told.warnings, *told.others_heard(recording))
