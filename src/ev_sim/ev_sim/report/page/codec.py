"""Signals as short texts for a page: whole steps, differences, bytes of one weight together, deflated, base64."""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass

import numpy as np

GAP = 0  # the code of what is not finite; numbers have the codes from 1 on
_LEVEL = 1  # of deflate: higher ones take twice the time for a tenth of the size


@dataclass(frozen=True, slots=True)
class Packed:
    """A series of `count` numbers: the n-th is low + (code_n - 1) step, a gap where its code is GAP.

    `text` holds the codes: base64 of deflate of `planes` rows of bytes, the lowest byte of every code first, of the
    differences of the codes modulo 256^planes (the first one against 0).
    """

    text: str
    low: float
    step: float
    count: int
    planes: int


def levels(planes: int) -> int:
    """Into how many steps the range of a series is divided."""
    return 256**planes - 4  # the code of a gap is none of them, and two are lost where zero is made one of them


def pack(values: np.ndarray, planes: int, step: float | None = None) -> Packed:
    """Pack values (n,), rounded to multiples of a step, the range over `levels` unless it is given: zero stays zero."""
    finite = np.isfinite(values)
    held = values[finite]
    low, high = (float(held.min()), float(held.max())) if len(held) else (0.0, 0.0)
    if step is None or (high - low) / step > levels(planes):
        step = (high - low) / levels(planes)
    if step > 0.0:
        low = float(np.floor(low / step)) * step
    codes = np.zeros(len(values), np.int64)
    codes[finite] = (np.rint((held - low) / step) if step > 0.0 else 0) + 1
    changes = np.diff(codes, prepend=0) & (256**planes - 1)
    rows = [(changes >> 8 * plane & 255).astype(np.uint8).tobytes() for plane in range(planes)]
    text = base64.b64encode(zlib.compress(b"".join(rows), _LEVEL)).decode()
    return Packed(text, low, step, len(values), planes)


def unpack(packed: Packed) -> np.ndarray:
    """The values (count,), NaN where there is a gap, as the page computes them."""
    raw = np.frombuffer(zlib.decompress(base64.b64decode(packed.text)), np.uint8)
    rows = raw.reshape(packed.planes, packed.count).astype(np.int64)
    codes = np.cumsum(sum(row << 8 * plane for plane, row in enumerate(rows))) & (256**packed.planes - 1)
    return np.where(codes == GAP, np.nan, packed.low + (codes - 1) * packed.step)
