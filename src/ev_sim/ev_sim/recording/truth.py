"""The true motion of a run: what its car did, where its sensors and faults have shown something else.

Nothing more has to be sent or recorded for it: the parts of the car are functions of what they read, and that stands in
the recording. So each part whose numbers were changed on their way says them again, without what changed them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ev_core.faults.row import channels_of, of_signals
from ev_core.lockstep.configuration import Configuration
from ev_core.sensors.row import imperfect
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.topics import TOPICS
from ev_sim.recording.recording import Recording

# The test bench is not among them: what its transducers show is what the source measured by.
OF_THE_CAR = ("plant", "steering_column", "rear_steering")


def true_motion(recording: Recording, configurations: Mapping[str, Configuration]) -> Recording:
    """The recording of a run of these configurations with the truth in the place of what was shown.

    Where a part says other numbers than were recorded even of what nothing has changed, the run was driven by something
    else (another node, the wall clock, parameters set live): then the changed channels are `unknown`.
    """
    struck = {role: struck_channels(configurations[role]) for role in OF_THE_CAR if role in configurations}
    if not any(struck.values()) or len(recording.time) < 2:
        return recording
    series, channels, unknown = _series(recording), dict(recording.channels), set[str]()
    for role, names in struck.items():
        if names:
            truth = _said_again(configurations[role], series, names)
            channels |= truth
            unknown |= names - truth.keys()
    return Recording(recording.time, channels, recording, frozenset(unknown))


def struck_channels(configuration: Configuration) -> set[str]:
    """The channels that sensors and faults of a role change."""
    of_faults = (channels_of(fault, configuration.method.writes) for fault in of_signals(configuration.faults))
    of_sensors = {
        name
        for quantity, _ in imperfect(configuration.sensors)
        for name, field in zip(TOPICS[quantity.signal].channels, shape_of(quantity.signal).channels, strict=True)
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


def _said_again(configuration: Configuration, series: np.ndarray, struck: set[str]) -> dict[str, np.ndarray]:
    """The truth of the channels that were struck; nothing of them if the others are not those of the recording."""
    from ev_core.lockstep.run import said_again  # numba is slow to import, and most runs are true as they are

    try:
        again = said_again(configuration, series)
    except SignalError:
        return {}
    places = {
        name: place
        for signal in configuration.method.writes
        for name, place in zip(TOPICS[signal].channels, frame.places(signal), strict=True)
    }
    untouched = [place for name, place in places.items() if name not in struck]
    return {name: again[places[name]] for name in struck} if (again[untouched] == series[untouched]).all() else {}
