"""The graph stepped without ROS: a whole run, and what is known of a run beyond its recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from ev_core.faults.row import channels_of, of_signals
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law_error import LawError
from ev_core.sensors.row import imperfect
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_stack.recording.outcome import Progress
from ev_stack.recording.recording import Recording, recording_of_series

if TYPE_CHECKING:
    from ev_core.lockstep.run import GraphRun

# The test bench is not among them: what its transducers show is what the source measured by.
OF_THE_CAR = ("plant", "steering_column", "rear_steering")


def run_offline(
    configurations: Mapping[str, Configuration],
    duration: float,
    progress: Progress = lambda time: None,
    note: Callable[[str, str], None] = lambda role, text: None,
) -> Recording:
    """The recording of all roles from rest to `duration` seconds, both ends included.

    `progress` is called with the simulated time now and then, `note` with each note of the object
    of a role. Raises ParameterError if the roles do not fit together, and SignalError if one of
    them gives a number that is not finite.
    """
    run = graph_run(configurations, duration)
    run.drive(progress, note)
    return recording_of_series(run.series, written_topics(configurations))


def graph_run(configurations: Mapping[str, Configuration], duration: float) -> GraphRun:
    """A run of all roles at rest, its code loaded, or compiled where it has never run."""
    from ev_core.lockstep.run import GraphRun  # numba is slow to import, here and below

    period = next(iter(configurations.values())).period
    return GraphRun(configurations, stamps.from_seconds(duration) // period + 1)


def written_topics(configurations: Mapping[str, Configuration]) -> list[Topic]:
    """The topics that the methods of a graph write, in the order of the topic table."""
    written = {
        signal
        for configuration in configurations.values()
        for signal in configuration.method.writes
    }
    return [topic for signal, topic in TOPICS.items() if signal in written]


def true_motion(recording: Recording, configurations: Mapping[str, Configuration]) -> Recording:
    """The recording of a run of these configurations with the truth in the place of what was shown.

    Where a part gives other numbers than were recorded even of what nothing has changed, something
    else has driven the run (another node, the wall clock, parameters set live): then the changed
    channels are `unknown`.
    """
    struck = {
        role: struck_channels(configurations[role]) for role in OF_THE_CAR if role in configurations
    }
    # Nothing was changed, or there is no step that could be taken again.
    if not any(struck.values()) or len(recording.time) < 2:
        return recording
    series, channels, unknown = _series(recording), dict(recording.channels), set[str]()
    for role, changed in struck.items():
        if changed:
            truth = _output_again(configurations[role], series, changed)
            channels |= truth
            unknown |= changed - truth.keys()
    return Recording(recording.time, channels, recording, frozenset(unknown))


def struck_channels(configuration: Configuration) -> set[str]:
    """The channels that sensors and faults of a role change."""
    of_faults = (
        channels_of(fault, configuration.method.writes)
        for fault in of_signals(configuration.faults)
    )
    of_sensors = {
        name
        for quantity, _ in imperfect(configuration.sensors)
        for name, field in zip(
            TOPICS[quantity.signal].channels, shape_of(quantity.signal).channels, strict=True
        )
        if field.partition(".")[0] in quantity.fields
    }
    return of_sensors | {name for struck in of_faults for name, *_ in struck}


def _series(recording: Recording) -> np.ndarray:
    series = np.zeros((frame.SIZE, len(recording.time)))
    series[frame.TIME] = recording.time
    for name, place in frame.channels().items():
        if name in recording.channels:
            series[place] = recording.channels[name]
    return series


def _output_again(
    configuration: Configuration, series: np.ndarray, struck: set[str]
) -> dict[str, np.ndarray]:
    """The truth of the channels that were struck.

    Nothing of them if the others are not those of the recording.
    """
    from ev_core.lockstep.run import output_again

    try:
        again = output_again(configuration, series)
    except (SignalError, LawError):
        return {}
    places = {
        name: place
        for signal in configuration.method.writes
        for name, place in zip(TOPICS[signal].channels, frame.places(signal), strict=True)
    }
    # To the last bit: where only one number differs, something else drove the run.
    untouched = [place for name, place in places.items() if name not in struck]
    return (
        {name: again[places[name]] for name in struck}
        if (again[untouched] == series[untouched]).all()
        else {}
    )
