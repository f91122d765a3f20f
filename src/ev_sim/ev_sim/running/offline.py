"""The graph without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.lockstep.configuration import Configuration
from ev_msgs_py.lockstep.run import GraphRun
from ev_sim.running.outcome import Outcome, Progress
from ev_sim.running.recording.recording import Recording, recording_of_series
from ev_sim.running.scenarios.scenario import Run


def run_offline(
    configurations: Mapping[str, Configuration],
    duration: float,
    progress: Progress = lambda time: None,
    note: Callable[[str, str], None] = lambda role, text: None,
) -> Recording:
    """The recording of all roles from rest to `duration` seconds, both ends included.

    `progress` is told the simulated time now and then, `note` each text that the object of a role has to say. Raises
    ParameterError if the roles do not fit together, and SignalError if one of them gives a number that is not finite.
    """
    period = next(iter(configurations.values())).period
    run = GraphRun(configurations, stamps.from_seconds(duration) // period + 1)
    run.drive(progress, note)
    written = {signal for configuration in configurations.values() for signal in configuration.method.writes}
    return recording_of_series(run.series, [topic for signal, topic in TOPICS.items() if signal in written])


def drive_offline(run: Run, progress: Progress = lambda time: None) -> Outcome:
    """Drive one run of a scenario; raises what `run_offline` does. To compile does not count as driving."""
    load_compiled(run.configurations)
    start = time.monotonic()
    notes: list[str] = []
    recording = run_offline(
        run.configurations, run.duration, progress, lambda role, text: notes.append(f"{run.namespace}/{role}: {text}")
    )
    return Outcome(recording, time.monotonic() - start, notes=tuple(notes))


def load_compiled(configurations: Mapping[str, Configuration]) -> None:
    """Load what these methods need, or compile it where it has never run; raises what `run_offline` does."""
    GraphRun(configurations, 1)
