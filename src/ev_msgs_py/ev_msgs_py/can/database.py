"""The frames of a bus from the text of a DBC file; nothing of the reader is used later.

A frame has its signals by name, and packs values into bytes and back.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ev_msgs_py.can.payload import COUNTERS, BitField, extracted, inserted, protected, raw_number
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

GUARDS = ("Crc", "Counter")  # signals that the protection writes
_GUARD_PLACES = {"Crc": (0, 8), "Counter": (8, 4)}  # start and length in bits, profile 1 variant 1A
_DATA_IDS = range(1 << 16)
_ENCODING = "cp1252"  # of DBC files
_STRING_OR_COMMENT = re.compile(r'"(?:\\"|[^"])*"|//[^\n]*')
_MULTIPLEXED = re.compile(r"SG_MUL_VAL_\s+\d")
_SIZES = re.compile(
    r"(\d+)\s*\|\s*(\d+)\s*@|BO_\s+\d+\s+\w+\s*:\s*(\d+)"
)  # start and length in bits, bytes

_MOST_BITS = 64
_LONGEST_SIGNAL = 32  # bits; a float64 and compiled code hold such numbers exactly
_SMALLEST = 1e-9
_LARGEST = 1e9


@dataclass(frozen=True, slots=True)
class FrameLayout:
    """One frame of the bus; `signals` are its signals by name, without those of the protection."""

    name: str
    identifier: int
    length: int  # bytes of data
    cycle: float  # s between two of them; 0: not cyclic
    sender: str
    receivers: frozenset[str]
    data_id: int
    signals: Mapping[str, BitField]
    units: Mapping[str, str]

    def __post_init__(self) -> None:
        object.__setattr__(self, "signals", MappingProxyType(dict(self.signals)))
        object.__setattr__(self, "units", MappingProxyType(dict(self.units)))

    def payload(self, values: Mapping[str, float]) -> int:
        """All signals as one number, without the protection; values beyond their range saturate.

        ValueError that names frame and signal for a NaN, and for names that are missing or unknown.
        """
        if values.keys() != self.signals.keys():
            different = sorted(values.keys() ^ self.signals.keys())
            raise ValueError(
                f"{self.name}: signals that are missing or unknown: {', '.join(different)}"
            )
        payload = 0
        for name, field in self.signals.items():
            value = values[name]
            if math.isnan(value):
                raise ValueError(
                    f"{self.name}: {name} is nan, expected {field.low:g} to {field.high:g}"
                )
            payload = inserted(payload, field, value)
        return payload

    def pack(self, values: Mapping[str, float], counter: int) -> bytes:
        """Protected data of the frame; ValueError as `payload`, and for a counter that is none."""
        if counter not in range(COUNTERS):
            raise ValueError(
                f"{self.name}: counter {counter} is refused, expected 0 to {COUNTERS - 1}"
            )
        return self.data(protected(self.payload(values), self.length, self.data_id, counter))

    def data(self, payload: int) -> bytes:
        """A payload as the bytes that go over the bus."""
        return payload.to_bytes(self.length, "little")

    def values(self, payload: int) -> dict[str, float]:
        """The signals of a payload by name, whether it is rightly protected or not."""
        return {name: extracted(payload, field) for name, field in self.signals.items()}


if TYPE_CHECKING:
    from cantools.database.can import Message, Signal


@dataclass(frozen=True, slots=True)
class Database:
    """The frames of a bus by name."""

    frames: Mapping[str, FrameLayout]

    def __getitem__(self, name: str) -> FrameLayout:
        if name not in self.frames:
            raise unknown_name("CAN frame", name, self.frames)
        return self.frames[name]

    def __iter__(self) -> Iterator[FrameLayout]:
        return iter(self.frames.values())


@lru_cache(maxsize=4)
def database_of(content: bytes) -> Database:
    """Frames that the content of a DBC file declares; reading takes as long as seconds of a run.

    ParameterError in one line that names frame and signal if it has what is not supported: anything
    but classic frames with 11-bit identifiers, Intel order, and the protection of profile 1.
    """
    from cantools.database import load_string  # takes 0.2 s that only nodes on a bus shall spend
    from cantools.database.errors import Error

    try:
        text = content.decode(_ENCODING)
        _refuse_what_unfolds(text)
        found: Any = load_string(text, database_format="dbc")
        layouts = [_layout(message) for message in found.messages]
    except (Error, UnicodeDecodeError) as error:
        what = re.sub(
            r'(column \d+): ".*', r"\1", str(error), flags=re.DOTALL
        )  # it goes on with what it has
        raise ParameterError(" ".join(what.split())) from None
    for what in ("name", "identifier"):
        seen = [getattr(layout, what) for layout in layouts]
        if twice := [each for each in seen if seen.count(each) > 1]:
            raise ParameterError(f"two frames with the {what} {twice[0]}")
    return Database({layout.name: layout for layout in layouts})


def _refuse_what_unfolds(text: str) -> None:
    """Refuse what the reader writes out, each bit and number of a range: it may mean gigabytes."""
    bare = _STRING_OR_COMMENT.sub(" ", text)
    if _MULTIPLEXED.search(bare):
        raise ParameterError("only classic frames with 11 bits and no multiplexing are spoken")
    for found in _SIZES.finditer(bare):
        if any(len(size) > 3 or int(size) > _MOST_BITS for size in found.groups("0")):
            raise ParameterError(
                f"{quoted(found[0])} is refused, expected frames of 8 bytes and the bits in them"
            )


def _layout(message: Message) -> FrameLayout:
    if message.is_extended_frame or message.is_fd or message.is_multiplexed() or message.length > 8:
        raise ParameterError(
            f"frame {message.name}: only classic frames with 11 bits and no multiplexing are spoken"
        )
    found = {signal.name: signal for signal in message.signals}
    for guard in GUARDS:
        place = (found[guard].start, found[guard].length) if guard in found else None
        if place != _GUARD_PLACES[guard]:
            raise ParameterError(
                f"frame {message.name}: {guard} must be at bit {_GUARD_PLACES[guard][0]}"
            )
    attributes = message.dbc.attributes if message.dbc else {}
    if "E2EDataId" not in attributes:
        raise ParameterError(f"frame {message.name}: the attribute E2EDataId is missing")
    data_id = attributes["E2EDataId"].value
    if data_id not in _DATA_IDS:
        raise ParameterError(
            f"frame {message.name}: E2EDataId {quoted(data_id)} is refused, expected 0 to "
            f"{_DATA_IDS[-1]}"
        )
    signals = {
        name: _field(message.name, signal) for name, signal in found.items() if name not in GUARDS
    }
    return FrameLayout(
        name=message.name,
        identifier=message.frame_id,
        length=message.length,
        cycle=(message.cycle_time or 0) / 1000.0,
        sender=message.senders[0] if message.senders else "",
        receivers=frozenset(message.receivers),
        data_id=int(data_id),
        signals=signals,
        units={name: found[name].unit or "1" for name in signals},
    )


def _field(frame: str, signal: Signal) -> BitField:
    if signal.byte_order != "little_endian" or signal.length > _LONGEST_SIGNAL or signal.is_float:
        raise ParameterError(
            f"frame {frame}, signal {signal.name}: only whole numbers in Intel order up to "
            f"{_LONGEST_SIGNAL} bits"
        )
    if signal.minimum is None or signal.maximum is None:
        raise ParameterError(f"frame {frame}, signal {signal.name}: the range is missing")
    scale, offset, low, high = (
        float(n) for n in (signal.scale, signal.offset, signal.minimum, signal.maximum)
    )
    if not (_SMALLEST <= scale <= _LARGEST and abs(offset) <= _LARGEST):
        raise ParameterError(
            f"frame {frame}, signal {signal.name}: scale {scale:g} and offset {offset:g} are "
            f"refused, expected "
            f"{_SMALLEST:g} to {_LARGEST:g} and at most {_LARGEST:g}"
        )
    least = -(1 << signal.length - 1) if signal.is_signed else 0
    most = least + (1 << signal.length) - 1
    first, last = offset + scale * least, offset + scale * most
    field = BitField(
        start=float(signal.start),
        length=float(signal.length),
        signed=float(signal.is_signed),
        scale=scale,
        steps=1.0 / scale,
        offset=offset,
        low=low,
        high=high,
    )
    # An offset of many more digits than the scale has is rounded: its ends may be steps away from
    # those of the bits.
    if not (
        first <= low <= high <= last
        and least <= raw_number(field, low) <= raw_number(field, high) <= most
    ):
        raise ParameterError(
            f"frame {frame}, signal {signal.name}: the range {low:g} to {high:g} is refused, "
            f"its {signal.length} bits hold {first:g} to {last:g}"
        )
    return field
