"""Takes a serialized message with the identity of its publisher, which rclpy passes on from Kilted on.

Where the C library of ROS is found by its name, messages are taken below rclpy, as the compiled
loop of a node (`node_loop`) does.
"""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

# `rcutils_uint8_array_t`, and room for more than `rmw_message_info_t`, in words of 8 bytes.
MESSAGE_WORDS, INFO_WORDS = 8, 32
CAPACITY = 4096  # bytes of a message that need not be asked for
# Words of the information on a message: when it was received [ns], and the identity of its
# publisher, which is two words long.
_RECEIVED, GID = 1, 5
_RCL_TAKE = ctypes.PYFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)


class Taken(NamedTuple):
    """A message, the identity of its publisher, and when the middleware received it [ns], 0 if it does not know."""

    message: bytes
    gid: bytes
    received: int


class End(NamedTuple):
    """A subscription or a publisher: its address, and how its messages look, as in `MessageFormat`."""

    address: int
    format: Any


@cache
def rcl() -> ctypes.CDLL | None:
    """Return the C library of ROS, None on a system that names its libraries differently."""
    try:
        return ctypes.CDLL("librcl.so")
    except OSError:
        return None


class _Allocator(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state")
    ]


def prepare_message(address: int) -> None:
    """Make an `rcutils_uint8_array_t` to take messages into.

    It grows with them, and lasts until it is freed.
    """
    rcutils = ctypes.CDLL("librcutils.so")
    rcutils.rcutils_get_default_allocator.restype = _Allocator
    allocator = rcutils.rcutils_get_default_allocator()
    rcutils.rcutils_uint8_array_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    if rcutils.rcutils_uint8_array_init(address, CAPACITY, ctypes.byref(allocator)) != 0:
        raise MemoryError(f"no {CAPACITY} bytes for a message")


def free_message(address: int) -> None:
    """Free what `prepare_message` has made, grown as it may be."""
    ctypes.CDLL("librcutils.so").rcutils_uint8_array_fini(ctypes.c_void_p(address))


def taker_of(handle: Any, message_class: type) -> Callable[[], Taken | None]:
    """Return a function that takes the next message of a subscription, None if there is none."""
    library = rcl()
    if library is None:
        return partial(_taken_by_rclpy, handle, message_class)
    return _Taker(handle, library)


def _taken_by_rclpy(handle: Any, message_class: type) -> Taken | None:
    """Take a message by rclpy's own means; the identity is empty before Kilted."""
    found = handle.take_message(message_class, True)
    if found is None:
        return None
    message, info = found
    gid = info.get("publisher_gid") or {"data": b""}
    return Taken(message, gid["data"], info["received_timestamp"])


class _Taker:
    """Takes messages by rcl, below rclpy."""

    def __init__(self, handle: Any, library: ctypes.CDLL) -> None:
        self._handle = handle
        words = self._words = np.zeros(MESSAGE_WORDS + INFO_WORDS, np.int64)
        self._message = words.ctypes.data
        self._info = self._message + MESSAGE_WORDS * words.itemsize
        prepare_message(self._message)
        weakref.finalize(self, lambda: free_message(words.ctypes.data))
        self._take = _RCL_TAKE(("rcl_take_serialized_message", library))

    def __call__(self) -> Taken | None:
        with self._handle:
            if self._take(self._handle.pointer, self._message, self._info, None) != 0:
                return None
        place, length = self._words[:2].tolist()
        info = self._words[MESSAGE_WORDS:]
        return Taken(
            ctypes.string_at(place, length), info[GID : GID + 2].tobytes(), int(info[_RECEIVED])
        )
