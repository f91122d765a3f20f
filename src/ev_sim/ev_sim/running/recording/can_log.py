"""The frames of a lockstep run as a log of the bus, beside its signals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ev_msgs_py.can.bus_model import BusModelParameters
from ev_msgs_py.can.bus_parameters import CIRCUITS
from ev_msgs_py.can.database import Database, load_database
from ev_msgs_py.can.frame_layout import FrameLayout
from ev_msgs_py.can.frames import DEVICES, SENT
from ev_msgs_py.can.payload_words import joined
from ev_msgs_py.can.schedule import TICK
from ev_msgs_py.can.wire_time import header, wire_bits
from ev_msgs_py.contract.bus_signals import MOST_TICKS
from ev_sim.running.recording.recording import Recording

if TYPE_CHECKING:
    from ev_msgs_py.can.bus_log import BusLog


class LoggedFrame(NamedTuple):
    """A frame on the wire; `time` [s] is the end of it."""

    time: float
    circuit: str
    identifier: int
    data: bytes


class _Kind(NamedTuple):
    """A frame as signals: begin of their names, layout, and the time [s] from the instant to its release."""

    channel: str
    layout: FrameLayout
    circuit: str
    offset: float


def write_can_log(log: BusLog, recording: Recording, bus: BusModelParameters) -> None:
    """Write all frames of a run and close the log."""
    import can

    for frame in logged_frames(recording, bus, load_database(bus.database)):
        log.write(
            can.Message(
                timestamp=frame.time,
                arbitration_id=frame.identifier,
                data=frame.data,
                is_extended_id=False,
                channel=f"can{frame.circuit}",
            )
        )
    log.close()


def logged_frames(recording: Recording, bus: BusModelParameters, database: Database) -> Iterator[LoggedFrame]:
    """The frames in the signals of a run, one after the other as they end on the wire.

    Set-points are those that were sent, feedback is what arrived: what was lost on the way back is in no signal.
    """
    period = float(recording.time[1] - recording.time[0]) if len(recording.time) > 1 else TICK
    waiting = sorted(
        (time, kind.layout.identifier, payload, kind)
        for kind in _kinds(database, period, bus.phase)
        for time, payload in _released(recording, kind)
    )
    free = dict.fromkeys(CIRCUITS, 0.0)
    found = []
    for time, identifier, payload, kind in waiting:
        head, length = header(identifier, kind.layout.length), kind.layout.length
        bits = wire_bits(*head, payload, length)
        free[kind.circuit] = max(free[kind.circuit], time) + bits / bus.bit_rate
        found.append(LoggedFrame(free[kind.circuit], kind.circuit, identifier, kind.layout.data(payload)))
    yield from sorted(found)


def _kinds(database: Database, period: float, phase: float) -> Iterator[_Kind]:
    for device in DEVICES:
        circuit, name = device[-2:], f"{device[:-2].lower()}_{device[-2:]}"
        for tick in range(MOST_TICKS):
            yield _Kind(f"can.set_points.{name}_{tick}", database[f"{device}_SetPoint"], circuit, tick * TICK)
            heard = tick * TICK + phase - period
            yield _Kind(f"can.feedback.{name}_motion_{tick}", database[f"{device}_Motion"], circuit, heard)
        for sent in SENT[1:]:  # of the ticks of a period it is not told which
            yield _Kind(f"can.feedback.{name}_{sent.lower()}", database[f"{device}_{sent}"], circuit, phase - TICK)
    for circuit in CIRCUITS:
        yield _Kind(f"can.set_points.heartbeat_{circuit}", database["Ecu_Heartbeat"], circuit, 0.0)


def _released(recording: Recording, kind: _Kind) -> Iterator[tuple[float, int]]:
    """Time of release [s] and payload of all frames of a kind."""
    channels = recording.channels
    low = channels.get(f"{kind.channel}_low", channels.get(kind.channel))
    if low is None:
        return
    high = channels.get(f"{kind.channel}_high", np.zeros(len(low)))
    for instant in np.flatnonzero(low >= 0.0):
        yield float(recording.time[instant]) + kind.offset, joined(low[instant], high[instant])
