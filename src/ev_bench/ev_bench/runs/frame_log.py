"""The frames of a run in lockstep, stepped again from its recording, as a log.

How it works: a recording has the signals that the bench has read, not its frames. So the bench is
stepped again with them, and the frames are taken from its state, as far as its bus does the same as
in the run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ev_bench.bus.model import SENT
from ev_bench.bus.parameters import CIRCUITS, load_database
from ev_bench.machines.circuits_on_can import CanCircuitsState, channel_layouts
from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.record import names
from ev_msgs_py.can.payload import joined
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.optional_signals import BusStates
from ev_stack.recording.recording import Recording

if TYPE_CHECKING:
    import can


class LoggedFrame(NamedTuple):
    """A frame on the wire; `time` [s] is the end of it."""

    time: float
    circuit: str
    identifier: int
    data: bytes


class FrameLog:
    """The log of the bus of one run in lockstep."""

    def __init__(self, log: can.Listener, bench: Configuration) -> None:
        self._log, self._bench = log, bench

    def write(self, recording: Recording) -> str:
        """Write all frames of a run and close the log; return the reason if it ends early."""
        import can

        frames, until = logged_frames(recording, self._bench)
        for each in frames:
            self._log(
                can.Message(
                    timestamp=each.time,
                    arbitration_id=each.identifier,
                    data=each.data,
                    is_extended_id=False,
                    channel=f"can{each.circuit}",
                )
            )
        self._log.stop()
        ends = (
            f"the log of the bus ends at {until:g} s: from there on the test bench was not what its"
            " parameters say"
        )
        return "" if until == recording.time[-1] else ends


def logged_frames(recording: Recording, bench: Configuration) -> tuple[list[LoggedFrame], float]:
    """Frames in the order in which they end, and the time [s] up to which the run is the same."""
    from ev_core.lockstep.parts import compiled_parts
    from ev_core.lockstep.run import call

    layouts = {
        c: channel_layouts(load_database(bench.parameters.bus.database), c) for c in CIRCUITS
    }
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
        # Load, latency and lost frames show whether the bench steps as it did in the run.
        if there[states].tolist() != [columns[place][instant] for place in states]:
            return sorted(found), float(recording.time[max(instant - 1, 0)])
        # No step follows the last instant.
        if instant == len(recording.time) - 1:
            break
        here[frame.TIME] = time
        here[read] = [columns[place][instant] for place in read]
        there[frame.TIME] = recording.time[instant + 1]
        for part in parts:
            call(part, here.ctypes.data, there)
        for circuit, count in counts.items():
            # In ChannelState the frames of a period stand right behind their number.
            begin, sent = count + 1, int(parts[0].state[count])
            for place, end, low, high in (
                parts[0].state[begin : begin + SENT * sent].reshape(sent, SENT).tolist()
            ):
                layout = layouts[circuit][int(place)]
                data = layout.data(joined(low, high))
                found.append(LoggedFrame(time + end / rate, circuit, layout.identifier, data))
    # Both channels were looked at one after the other; a frame begins with the time of its end.
    return sorted(found), float(recording.time[-1])
