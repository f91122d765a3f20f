"""A frame as the database declares it: its signals, and values to bytes and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ev_msgs_py.can.payload import BitField, extracted, inserted
from ev_msgs_py.can.protection import COUNTERS, protected

GUARDS = ("Crc", "Counter")  # signals that the protection writes


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
            raise ValueError(f"{self.name}: signals that are missing or unknown: {', '.join(different)}")
        payload = 0
        for name, field in self.signals.items():
            value = values[name]
            if math.isnan(value):
                raise ValueError(f"{self.name}: {name} is nan, allowed is {field.low:g} to {field.high:g}")
            payload = inserted(payload, field, value)
        return payload

    def pack(self, values: Mapping[str, float], counter: int) -> bytes:
        """The data of the frame, protected; ValueError as `payload`, and for a counter that is none."""
        if counter not in range(COUNTERS):
            raise ValueError(f"{self.name}: counter {counter} is refused, allowed is 0 to {COUNTERS - 1}")
        return self.data(protected(self.payload(values), self.length, self.data_id, counter))

    def data(self, payload: int) -> bytes:
        """A payload as the bytes that go over the bus."""
        return payload.to_bytes(self.length, "little")

    def values(self, payload: int) -> dict[str, float]:
        """The signals of a payload by name, whether it is rightly protected or not."""
        return {name: extracted(payload, field) for name, field in self.signals.items()}
