"""The functions of ROS's C library (rcl), below rclpy, that the compiled loop of a node calls by their addresses."""

from __future__ import annotations

import ctypes
from functools import cache

# `rcutils_uint8_array_t`, and room for more than `rmw_message_info_t`, in words of 8 bytes.
MESSAGE_WORDS, INFO_WORDS = 8, 32


@cache
def addresses() -> dict[str, int]:
    """By the names that the compiled loop gives them; none on a system that names its libraries differently."""
    try:
        rcl, libc = ctypes.CDLL("librcl.so"), ctypes.CDLL(None)
    except OSError:
        return {}
    functions = {
        "rcl_take": rcl.rcl_take_serialized_message,
        "rcl_publish": rcl.rcl_publish_serialized_message,
        "rcl_count": rcl.rcl_publisher_get_subscription_count,
        "rcl_clear": rcl.rcl_wait_set_clear,
        "rcl_add": rcl.rcl_wait_set_add_subscription,
        "rcl_add_guard": rcl.rcl_wait_set_add_guard_condition,
        "rcl_wait": rcl.rcl_wait,
        "clock_gettime": libc.clock_gettime,
        "memcpy": libc.memcpy,
    }
    return {name: ctypes.cast(function, ctypes.c_void_p).value or 0 for name, function in functions.items()}


class _Allocator(ctypes.Structure):
    _fields_ = [(name, ctypes.c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state")]


def prepare_message(address: int, capacity: int) -> None:
    """Make an `rcutils_uint8_array_t` for what is taken; it grows with the messages, and lasts like the process."""
    rcutils = ctypes.CDLL("librcutils.so")
    rcutils.rcutils_get_default_allocator.restype = _Allocator
    allocator = rcutils.rcutils_get_default_allocator()
    rcutils.rcutils_uint8_array_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    if rcutils.rcutils_uint8_array_init(address, capacity, ctypes.byref(allocator)) != 0:
        raise MemoryError(f"no {capacity} bytes for a message")
