"""One fault that is put into a circuit on its bus, from one instant to another.

How it works: `present` gives the kind of fault in a tick. Faults of an inverter go into its state
(`put_in`), those of the bus change the set-point on its way (`on_the_way`), and those of the
transducer change what it measures (`measured`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from ev_bench.inverter.device import Injected
from ev_core.law import ParameterError, compilable, entry, setting
from ev_msgs_py.can.frames import TICK
from ev_msgs_py.can.payload import NO_FRAME

FAULTY_DRIVES = ("right", "left")
# With these values nothing would be wrong.
_WITHOUT_EFFECT = {
    "hot_winding": 0.0,
    "hot_inverter": 0.0,
    "over_voltage": 0.0,
    "over_current": 0.0,
    "transducer_offset": 0.0,
    "transducer_gain": 1.0,
}
_ROUNDING = 1e-9  # s, by which the time of a tick may be off


class BusFault(IntEnum):
    """The kinds of faults, named as the parameter's choices."""

    NONE = 0
    LOST_FRAMES = 1
    WRONG_CRC = 2
    WRONG_COUNTER = 3
    SILENT = 4
    FEEDBACK_WRONG_CRC = 5
    FEEDBACK_WRONG_COUNTER = 6
    HOT_WINDING = 7
    HOT_INVERTER = 8
    TRIP = 9
    DC_LINK_LOSS = 10
    OVER_VOLTAGE = 11
    OVER_CURRENT = 12
    TRANSDUCER_OFFSET = 13
    TRANSDUCER_GAIN = 14
    LOAD_LIMIT = 15


def _first_tick(time: float) -> int:
    """The first tick that is not before a time [s]."""
    return math.ceil((time - _ROUNDING) / TICK)


@dataclass(frozen=True, slots=True)
class BusFaultParameters:
    """A fault of the bus: its kind, its circuit, and its time."""

    kind: str = setting(
        "none", choices=tuple(each.name.lower() for each in BusFault), about="what goes wrong"
    )
    drive: str = setting("right", choices=FAULTY_DRIVES, about="of which circuit")
    begin: float = setting(0.0, unit="s", low=0.0, high=1e5, about="from then on")
    end: float = setting(1e5, unit="s", low=0.0, high=1e5, about="until then")
    value: float = setting(
        0.0,
        unit="SI",
        low=-1e3,
        high=1e3,
        about=(
            "how much: K of hot_*, V, A, N m of transducer_offset and load_limit, share of"
            " transducer_gain, the bit of wrong_crc"
        ),
    )

    def __post_init__(self) -> None:
        """ParameterError for a fault that would never strike, or change nothing."""
        if self.kind == "none":
            return
        if _first_tick(self.end) <= _first_tick(self.begin):
            raise ParameterError(
                f"end: {self.end!r} is refused beside begin {self.begin!r}, expected a multiple of"
                f" {TICK:g} s from begin on and before end: the fault would never strike"
            )
        if self.kind == "load_limit" and self.value < 0.0:
            raise ParameterError(
                f"value: {self.value!r} is refused beside kind load_limit, expected 0 or more"
            )
        if self.value == _WITHOUT_EFFECT.get(self.kind):
            raise ParameterError(
                f"value: {self.value!r} is refused beside kind {self.kind}, expected another one:"
                " it changes nothing"
            )


@dataclass(slots=True)
class BusFaultState:
    """State of a fault between ticks."""

    low: float = entry(
        NO_FRAME, unit="1", about="words of the set-point that comes again and again"
    )
    high: float = entry(NO_FRAME, unit="1")


class Words(NamedTuple):
    """A frame, or NO_FRAME."""

    low: float
    high: float


@compilable
def present(p: BusFaultParameters, tick: float, channel: int) -> int:
    """The kind that is there in a tick on a channel, 0 for the right circuit and 1 for the left."""
    there = (
        int(p.drive) == channel
        and p.begin <= tick * TICK + _ROUNDING
        and tick * TICK + _ROUNDING < p.end
    )
    return int(p.kind) if there else 0


@compilable
def put_in(p: BusFaultParameters, injected: Injected, kind: int) -> None:
    """Let the inverter have this fault, and no other one."""
    injected.trip = 1.0 if kind == BusFault.TRIP else 0.0
    injected.supply_lost = 1.0 if kind == BusFault.DC_LINK_LOSS else 0.0
    injected.winding_rise = p.value if kind == BusFault.HOT_WINDING else 0.0
    injected.inverter_rise = p.value if kind == BusFault.HOT_INVERTER else 0.0
    injected.voltage_rise = p.value if kind == BusFault.OVER_VOLTAGE else 0.0
    injected.current_rise = p.value if kind == BusFault.OVER_CURRENT else 0.0
    injected.silent = 1.0 if kind == BusFault.SILENT else 0.0
    injected.wrong_crc = 1.0 if kind == BusFault.FEEDBACK_WRONG_CRC else 0.0
    injected.frozen_counter = 1.0 if kind == BusFault.FEEDBACK_WRONG_COUNTER else 0.0


@compilable
def on_the_way(
    p: BusFaultParameters, s: BusFaultState, kind: int, low: float, high: float
) -> Words:
    """Set-point that arrives under a fault: the same, another one, or none."""
    # The frame that is repeated is the first one of each time that the fault lasts.
    if kind != BusFault.WRONG_COUNTER:
        s.low = s.high = NO_FRAME
    if low == NO_FRAME or kind == BusFault.LOST_FRAMES:
        return Words(NO_FRAME, NO_FRAME)
    if kind == BusFault.WRONG_COUNTER:
        if s.low == NO_FRAME:
            s.low, s.high = low, high
        return Words(s.low, s.high)
    if kind == BusFault.WRONG_CRC:
        bit = int(p.value) % 64
        if bit < 32:
            return Words(float(int(low) ^ (1 << bit)), high)
        return Words(low, float(int(high) ^ (1 << (bit - 32))))
    return Words(low, high)


@compilable
def measured(p: BusFaultParameters, kind: int, torque: float) -> float:
    """Torque [N m] that the transducer measures."""
    if kind == BusFault.TRANSDUCER_OFFSET:
        return torque + p.value
    return torque * p.value if kind == BusFault.TRANSDUCER_GAIN else torque
