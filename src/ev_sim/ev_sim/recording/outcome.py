"""What driving one run of a scenario gives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ev_sim.recording.recording import Recording

Progress = Callable[[float], None]  # is told the simulated time now and then


class RunFailed(RuntimeError):
    """A run did not come to its end; the message is one line for the user."""


@dataclass(frozen=True)
class Outcome:
    """The signals of a run, the wall time of driving [s], why it may not be reproducible, and what nodes noted.

    `timing` is how well real time was kept (`nodes/master/real_time.py`), empty of a run in lockstep.
    """

    recording: Recording
    wall_time: float
    not_reproducible: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    timing: Mapping[str, Any] = field(default_factory=dict)
