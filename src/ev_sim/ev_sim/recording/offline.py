"""The graph stepped without ROS: a whole run, and what is known of a run beyond its recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ev_core.bus.model import SENT
from ev_core.bus.parameters import CIRCUITS, load_database
from ev_core.faults.row import channels_of, of_signals
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law_error import LawError
from ev_core.parameters.record import names
from ev_core.sensors.row import imperfect
from ev_msgs_py.can.payload import joined
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.optional_signals import BusStates
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_sim.recording.outcome import Progress
from ev_sim.recording.recording import Recording, recording_of_series
from ev_sim.test_bench.circuits_on_can import CanCircuitsState, channel_layouts


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
    from ev_core.lockstep.run import GraphRun  # numba is slow to import, here and below

    period = next(iter(configurations.values())).period
    run = GraphRun(configurations, stamps.from_seconds(duration) // period + 1)
    run.drive(progress, note)
    return recording_of_series(run.series, written_topics(configurations))


def written_topics(configurations: Mapping[str, Configuration]) -> list[Topic]:
    """The topics that the methods of a graph write, in the order of the topic table."""
    written = {signal for configuration in configurations.values() for signal in configuration.method.writes}
    return [topic for signal, topic in TOPICS.items() if signal in written]


def load_compiled(configurations: Mapping[str, Configuration]) -> None:
    """Load what these methods need, or compile it where it has never run; raises what `run_offline` does."""
    from ev_core.lockstep.run import GraphRun

    GraphRun(configurations, 1)


# The test bench is not among them: what its transducers show is what the source measured by.
OF_THE_CAR = ("plant", "steering_column", "rear_steering")


def true_motion(recording: Recording, configurations: Mapping[str, Configuration]) -> Recording:
    """The recording of a run of these configurations with the truth in the place of what was shown.

    Where a part gives other numbers than were recorded even of what nothing has changed, something else has driven the
    run (another node, the wall clock, parameters set live): then the changed channels are `unknown`.
    """
    struck = {role: struck_channels(configurations[role]) for role in OF_THE_CAR if role in configurations}
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


def _output_again(configuration: Configuration, series: np.ndarray, struck: set[str]) -> dict[str, np.ndarray]:
    """The truth of the channels that were struck; nothing of them if the others are not those of the recording."""
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
    untouched = [place for name, place in places.items() if name not in struck]
    return {name: again[places[name]] for name in struck} if (again[untouched] == series[untouched]).all() else {}


if TYPE_CHECKING:
    import can


class LoggedFrame(NamedTuple):
    """A frame on the wire; `time` [s] is the end of it."""

    time: float
    circuit: str
    identifier: int
    data: bytes


def write_can_log(log: can.Listener, recording: Recording, bench: Configuration) -> str:
    """Write all frames of a run and close the log; a line with the reason if it ends before the run does."""
    import can

    frames, until = logged_frames(recording, bench)
    for each in frames:
        log(
            can.Message(
                timestamp=each.time,
                arbitration_id=each.identifier,
                data=each.data,
                is_extended_id=False,
                channel=f"can{each.circuit}",
            )
        )
    log.stop()
    ends = f"the log of the bus ends at {until:g} s: from there on the test bench was not what its parameters say"
    return "" if until == recording.time[-1] else ends


def logged_frames(recording: Recording, bench: Configuration) -> tuple[list[LoggedFrame], float]:
    """The frames on the wire, one after the other as they end, and until when [s] the bench is the recorded one."""
    from ev_core.lockstep.parts import compiled_parts
    from ev_core.lockstep.run import call

    layouts = {c: channel_layouts(load_database(bench.parameters.bus.database), c) for c in CIRCUITS}
    rate = bench.parameters.bus.bit_rate
    counts = {c: names(CanCircuitsState()).index(f"line_{c}.channel.sent_count") for c in CIRCUITS}
    columns = {frame.channels()[name]: values for name, values in recording.channels.items()}
    read = [place for signal in bench.method.reads for place in frame.places(signal)]
    states = list(frame.places(BusStates))
    parts = compiled_parts(bench)
    here, there = np.zeros(frame.SIZE), np.zeros(frame.SIZE)
    for part in parts:
        call(part, 0, there)
    found = []
    for instant, time in enumerate(recording.time):
        if there[states].tolist() != [columns[place][instant] for place in states]:
            return sorted(found), float(recording.time[max(instant - 1, 0)])
        if instant == len(recording.time) - 1:
            break
        here[frame.TIME] = time
        here[read] = [columns[place][instant] for place in read]
        there[frame.TIME] = recording.time[instant + 1]
        for part in parts:
            call(part, here.ctypes.data, there)
        for circuit, count in counts.items():
            begin, sent = count + 1, int(parts[0].state[count])
            for place, end, low, high in parts[0].state[begin : begin + SENT * sent].reshape(sent, SENT).tolist():
                layout = layouts[circuit][int(place)]
                data = layout.data(joined(low, high))
                found.append(LoggedFrame(time + end / rate, circuit, layout.identifier, data))
    return sorted(found), float(recording.time[-1])
