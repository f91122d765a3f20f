"""Takes a serialized message with the identity of its publisher, which rclpy passes on from Kilted on."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from ev_nodes.node_loop.ordinary_steps import (
    CAPACITY,
    INFO_WORDS,
    MESSAGE_WORDS,
    addresses,
    free_message,
    prepare_message,
)
from ev_nodes.node_loop.steps import GID

Taken = tuple[bytes, Mapping[str, Any]]

# Words of the information on a message: the time of its reception [ns], its publisher's number.
_RECEIVED, _NUMBER = 1, 2
_RCL_TAKE = ctypes.PYFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 4)


def taker_of(handle: Any, message_class: type) -> Callable[[], Taken | None]:
    """Return a function that takes the next message of a subscription, and its information as rclpy 9 gives it."""
    if not addresses():  # on a system that names its libraries differently: rclpy's own way
        return partial(handle.take_message, message_class, True)
    return _Taker(handle)


class _Taker:
    """Takes messages as the compiled loop does: by rcl, below rclpy."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        words = self._words = np.zeros(MESSAGE_WORDS + INFO_WORDS, np.int64)
        self._message = words.ctypes.data
        self._info = self._message + MESSAGE_WORDS * words.itemsize
        prepare_message(self._message, CAPACITY)
        weakref.finalize(self, lambda: free_message(words.ctypes.data))
        self._take = _RCL_TAKE(addresses()["rcl_take"])

    def __call__(self) -> Taken | None:
        with self._handle:
            if self._take(self._handle.pointer, self._message, self._info, None) != 0:
                return None
        place, length = self._words[:2].tolist()
        info = self._words[MESSAGE_WORDS:]
        return ctypes.string_at(place, length), {
            "received_timestamp": int(info[_RECEIVED]),
            "publication_sequence_number": int(info[_NUMBER]),
            "publisher_gid": {"data": info[GID : GID + 2].tobytes()},
        }
