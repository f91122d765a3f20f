"""End-to-end protection of a payload by AUTOSAR E2E profile 1: what the receiver makes of it.

How it works: a receiver calls `check` for each frame that has come, and `no_new_data` for each
cycle without one. Each call widens the step of the counter that is tolerated, and a right frame
narrows it again. After a wrong step or a long silence frames may be right, but their content is not
used until enough of them have followed each other.

The algorithm of E2E_P01Check (AUTOSAR PRS E2E protocol, profile 1), with its names for what lasts
between two calls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.parameters.record import entry
from ev_msgs_py.can.payload import COUNTERS, checksum, counter_of
from ev_msgs_py.compilable import compilable

STATUS_NAMES = (
    "ok",
    "no new data",
    "wrong crc",
    "synchronising",
    "initial",
    "repeated",
    "ok, some lost",
    "wrong sequence",
)
OK, NO_NEW_DATA, WRONG_CRC, SYNC, INITIAL, REPEATED, OK_SOME_LOST, WRONG_SEQUENCE = range(
    len(STATUS_NAMES)
)
# Counters run from 0 to 14: a step of a whole turn looks like none.
_LARGEST_COUNT = 14


class CheckSettings(NamedTuple):
    """Tolerances of a receiver."""

    # step of the counter from frame to frame: up to two frames may be lost
    max_delta_counter_init: float = 3.0
    # calls without a new frame after which it must synchronise again
    max_no_new_or_repeated_data: float = 5.0
    sync_counter_init: float = 1.0  # right frames in a row that synchronising takes


TOLERANCES = CheckSettings()


@dataclass(slots=True)
class CheckState:
    """State of a receiver for the frames with one identifier."""

    wait_for_first_data: float = entry(1.0, unit="1")
    last_valid_counter: float = entry(unit="1")
    max_delta_counter: float = entry(
        unit="1", about="largest step that is tolerated now; grows by 1 with each call"
    )
    no_new_or_repeated_data_counter: float = entry(unit="1")
    sync_counter: float = entry(unit="1")
    lost_data: float = entry(unit="1", about="frames that were lost before the newest one")
    status: float = entry(float(NO_NEW_DATA), unit="1", about="place in STATUS_NAMES")


@compilable
def is_valid(status: int) -> bool:
    """Return True if the content of a frame with this status may be used."""
    return status in (OK, OK_SOME_LOST)


@compilable
def no_new_data(s: CheckState) -> int:
    """A cycle of the receiver has passed without a frame; the status."""
    # Each cycle without a frame makes room for one more that is lost.
    s.max_delta_counter = min(s.max_delta_counter + 1.0, _LARGEST_COUNT)
    return _not_new(s, NO_NEW_DATA)


@compilable
def check(c: CheckSettings, s: CheckState, payload: int, length: int, data_id: int) -> int:
    """Judge a frame of `length` bytes that has come; the status."""
    s.max_delta_counter = min(s.max_delta_counter + 1.0, _LARGEST_COUNT)
    counter = counter_of(payload)
    if payload & 0xFF != checksum(payload, length, data_id) or counter >= COUNTERS:
        # neither new nor repeated: the counter of those goes on with neither
        s.status = float(WRONG_CRC)
        return WRONG_CRC
    if s.wait_for_first_data != 0.0:
        s.wait_for_first_data = 0.0
        _take(c, s, counter)
        s.status = float(INITIAL)
        return INITIAL
    delta = (counter - int(s.last_valid_counter)) % COUNTERS
    if delta == 0:
        return _not_new(s, REPEATED)
    return _follow(c, s, counter, delta)


@compilable
def _follow(c: CheckSettings, s: CheckState, counter: int, delta: int) -> int:
    # More are lost than is tolerated: begin again from this counter, by `sync_counter_init` right
    # ones.
    if delta > s.max_delta_counter:
        s.no_new_or_repeated_data_counter = 0.0
        s.sync_counter = c.sync_counter_init
        if s.sync_counter > 0.0:
            _take(c, s, counter)
        status = WRONG_SEQUENCE
    else:
        _take(c, s, counter)
        s.lost_data = float(delta - 1)
        # After a long silence the right counter is chance: synchronise first.
        if s.no_new_or_repeated_data_counter > c.max_no_new_or_repeated_data:
            s.sync_counter = c.sync_counter_init
            status = SYNC
        elif s.sync_counter > 0.0:
            s.sync_counter -= 1.0
            status = SYNC
        else:
            status = OK if delta == 1 else OK_SOME_LOST
        s.no_new_or_repeated_data_counter = 0.0
    s.status = float(status)
    return status


@compilable
def _take(c: CheckSettings, s: CheckState, counter: int) -> None:
    s.max_delta_counter = c.max_delta_counter_init
    s.last_valid_counter = float(counter)
    s.lost_data = 0.0


@compilable
def _not_new(s: CheckState, status: int) -> int:
    s.no_new_or_repeated_data_counter = min(s.no_new_or_repeated_data_counter + 1.0, _LARGEST_COUNT)
    s.status = float(status)
    return status
