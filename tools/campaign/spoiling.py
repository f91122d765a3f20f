"""Messages that nobody can read, or that no node may believe."""

from __future__ import annotations

import random
import struct

HOW = ("nan", "short", "long", "garbage", "names", "frame", "big endian", "far stamp", "no stamp")
_WORD = 4  # bytes
_NAN = struct.pack("<d", float("nan"))
_NAMES = ((b"front_left", b"front_loft"), (b"drive", b"drove"), (b"load", b"lood"))
_FRAMES = ((b"base_link", b"base_lime"), (b"map", b"mop"))


def spoilt(message: bytes, how: str, chance: random.Random) -> bytes:
    """A message of which something is wrong; where it has no such part, its end is missing."""
    if how == "nan" and len(message) > 24:
        return message[: -len(_NAN)] + _NAN
    if how == "long":
        return message + bytes(chance.randrange(1, 100))
    if how == "garbage":
        return message[:4] + chance.randbytes(len(message) - 4)
    if how in ("names", "frame"):
        for old, new in _NAMES if how == "names" else _FRAMES:
            if old in message:
                return message.replace(old, new)
    if how == "big endian":
        return b"\x00\x00" + message[2:]
    if how == "far stamp":
        return message[:4] + struct.pack("<iI", chance.randrange(10**3, 10**9), 7) + message[12:]
    if how == "no stamp":
        return message[:4]
    # Fewer whole words: DDS would fill the last one up again, with another number in it.
    return message[: chance.randrange(4, max((len(message) - 1) // _WORD * _WORD + 1, 5))]
