"""One fault that is put into a circuit on its bus, from one instant to another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import compilable, entry, setting
from ev_msgs_py.can.frames import TICK
from ev_msgs_py.can.payload import NO_FRAME
from ev_sim.test_bench.state import CircuitState

KINDS = (
    "none",
    "lost_frames",
    "wrong_crc",
    "wrong_counter",
    "silent",
    "feedback_wrong_crc",
    "feedback_wrong_counter",
    "hot_winding",
    "hot_inverter",
    "trip",
    "dc_link_loss",
    "over_voltage",
    "over_current",
    "transducer_offset",
    "transducer_gain",
    "load_limit",
)
(
    NONE,
    LOST_FRAMES,
    WRONG_CRC,
    WRONG_COUNTER,
    SILENT,
    FEEDBACK_WRONG_CRC,
    FEEDBACK_WRONG_COUNTER,
    HOT_WINDING,
    HOT_INVERTER,
    TRIPPED,
    SUPPLY_LOST,
    OVER_VOLTAGE,
    OVER_CURRENT,
    TRANSDUCER_OFFSET,
    TRANSDUCER_GAIN,
    LOAD_LIMIT,
) = range(len(KINDS))
DRIVES = ("right", "left")


@dataclass(frozen=True, slots=True)
class BusFaultParameters:
    """What is put into which circuit, and when."""

    kind: str = setting("none", choices=KINDS, about="what goes wrong")
    drive: str = setting("right", choices=DRIVES, about="of which circuit")
    begin: float = setting(0.0, unit="s", low=0.0, high=1e5, about="from then on")
    end: float = setting(1e5, unit="s", low=0.0, high=1e5, about="until then")
    value: float = setting(
        0.0, unit="SI", low=-1e3, high=1e3,
        about="how much: K of hot_*, V, A, N m of transducer_offset and load_limit, share of transducer_gain, the bit "
        "of wrong_crc",
    )  # fmt: skip


@dataclass(slots=True)
class FaultState:
    """What lasts of it."""

    low: float = entry(NO_FRAME, unit="1", about="words of the set-point that comes again and again")
    high: float = entry(NO_FRAME, unit="1")


class Words(NamedTuple):
    """A frame, or NO_FRAME."""

    low: float
    high: float


@compilable
def present(p: BusFaultParameters, tick: float, channel: int) -> int:
    """The kind that is there in a tick on a channel, 0 for the right circuit and 1 for the left."""
    there = int(p.drive) == channel and p.begin <= tick * TICK + 1e-9 and tick * TICK + 1e-9 < p.end
    return int(p.kind) if there else NONE


@compilable
def put_in(p: BusFaultParameters, s: CircuitState, kind: int) -> None:
    """Let the inverter have this fault, and no other one."""
    i = s.machine.injected
    i.trip = 1.0 if kind == TRIPPED else 0.0
    i.supply_lost = 1.0 if kind == SUPPLY_LOST else 0.0
    i.winding_rise = p.value if kind == HOT_WINDING else 0.0
    i.inverter_rise = p.value if kind == HOT_INVERTER else 0.0
    i.voltage_rise = p.value if kind == OVER_VOLTAGE else 0.0
    i.current_rise = p.value if kind == OVER_CURRENT else 0.0
    i.silent = 1.0 if kind == SILENT else 0.0
    i.wrong_crc = 1.0 if kind == FEEDBACK_WRONG_CRC else 0.0
    i.frozen_counter = 1.0 if kind == FEEDBACK_WRONG_COUNTER else 0.0


@compilable
def on_the_way(p: BusFaultParameters, s: FaultState, kind: int, low: float, high: float) -> Words:
    """What arrives of a set-point: the same, another one, or none."""
    if kind != WRONG_COUNTER:
        s.low = s.high = NO_FRAME
    if low == NO_FRAME or kind == LOST_FRAMES:
        return Words(NO_FRAME, NO_FRAME)
    if kind == WRONG_COUNTER:
        if s.low == NO_FRAME:
            s.low, s.high = low, high
        return Words(s.low, s.high)
    if kind == WRONG_CRC:
        bit = int(p.value) % 64
        if bit < 32:
            return Words(float(int(low) ^ (1 << bit)), high)
        return Words(low, float(int(high) ^ (1 << (bit - 32))))
    return Words(low, high)


@compilable
def measured(p: BusFaultParameters, kind: int, torque: float) -> float:
    """What the transducer says of a torque [N m]."""
    if kind == TRANSDUCER_OFFSET:
        return torque + p.value
    return torque * p.value if kind == TRANSDUCER_GAIN else torque
