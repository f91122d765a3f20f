"""The graph without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.run import GraphRun
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import TOPICS
from ev_sim.recording.outcome import Progress
from ev_sim.recording.recording import Recording, recording_of_series


def run_offline(
    configurations: Mapping[str, Configuration],
    duration: float,
    progress: Progress = lambda time: None,
    note: Callable[[str, str], None] = lambda role, text: None,
) -> Recording:
    """The recording of all roles from rest to `duration` seconds, both ends included.

    `progress` is called with the simulated time now and then, `note` with each note of the object of a role. Raises
    ParameterError if the roles do not fit together, and SignalError if one of them gives a number that is not finite.
    """
    period = next(iter(configurations.values())).period
    run = GraphRun(configurations, stamps.from_seconds(duration) // period + 1)
    run.drive(progress, note)
    written = {signal for configuration in configurations.values() for signal in configuration.method.writes}
    return recording_of_series(run.series, [topic for signal, topic in TOPICS.items() if signal in written])


def load_compiled(configurations: Mapping[str, Configuration]) -> None:
    """Load what these methods need, or compile it where it has never run; raises what `run_offline` does."""
    GraphRun(configurations, 1)
