"""C functions that are called by their address, from compiled code and from plain Python alike."""

from __future__ import annotations

import ctypes

FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)


def call(address: int, first: int, second: int, third: int, fourth: int) -> int:
    """Call a C function that takes up to four pointers or integers; the result is the status that it returns."""
    status: int = FUNCTION(address)(first, second, third, fourth)
    return status
