"""The memory of the compiled loop of a node, and the functions of rcl, below rclpy, that the loop calls."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from ev_core.lockstep.tally import Tally
from ev_core.node_loop.message_memory import RUN
from ev_core.node_loop.records import HEAD, INPUT, OUTPUT
from ev_core.node_loop.steps import GID
from ev_msgs_py.contract.frame import SIZE, Frame
from ev_msgs_py.wire.message_format import ENCAPSULATION, MessageFormat, Run

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


_SENDERS = 8  # of each input: who may speak, and others who are known to be refused
_CAPACITY = 4096  # bytes of a message that need not be asked for


class End(NamedTuple):
    """A subscription or a publisher, by its address, and how its messages look, as in `wire.message_format`."""

    address: int
    template: bytes
    mask: bytes = b""
    runs: Sequence[Run] = ()
    single: bool = False

    @classmethod
    def of(cls, address: int, format_: MessageFormat) -> End:
        """Of the messages of a format."""
        return cls(address, format_.template, format_.mask, format_.runs, format_.code == "f")


class StepMemory:
    """Arrays of records for one node; they last as long as the loop may be called."""

    def __init__(self, inputs: Sequence[End], outputs: Sequence[End], tally: Tally | None) -> None:
        self._block = bytearray()
        self.head = np.zeros(1, HEAD)
        self.inputs, self.outputs = np.zeros(len(inputs), INPUT), np.zeros(len(outputs), OUTPUT)
        self.senders = np.full((len(inputs), _SENDERS, 2), -1)
        self.frames = np.zeros((4, SIZE))
        self.runs = np.array([tuple(run) for end in (*inputs, *outputs) for run in end.runs], RUN)
        head, run = self.head[0], 0
        for name, words in (("message", MESSAGE_WORDS), ("info", INFO_WORDS), ("clock", 2), ("count", 1)):
            head[name] = self._words(words)
        head["heard"] = self._place(bytes(max(len(end.template) for end in inputs)))
        for row, end in zip((*self.inputs, *self.outputs), (*inputs, *outputs), strict=True):
            row["template"], row["mask"] = self._place(end.template), self._place(end.mask)
            row["length"], row["single"] = len(end.template), end.single
            row["first"], row["last"] = run, run + len(end.runs)
            run += len(end.runs)
        self.inputs["subscription"] = [end.address for end in inputs]
        self.outputs["publisher"] = [end.address for end in outputs]
        self.outputs["message"] = [self._words(MESSAGE_WORDS) for _ in outputs]
        self.words = np.frombuffer(self._block + bytes(-len(self._block) % 8), np.int64).copy()
        here = self.words.ctypes.data
        prepare_message(here + 8 * int(head["message"]), _CAPACITY)
        for row in self.outputs:  # without an allocator: nobody makes them grow
            at = int(row["message"])
            self.words[at : at + 3] = here + row["template"], row["length"], row["length"]
        sizes = (len(inputs), len(outputs), len(self.runs), _SENDERS, SIZE, self.words.nbytes)
        for name, size in zip(("inputs", "outputs", "runs", "senders", "width", "size"), sizes, strict=True):
            head[name] = size
        arrays = (self.head, self.inputs, self.outputs, self.runs, self.senders, self.frames, self.words)
        self.addresses = tuple(array.ctypes.data for array in arrays)
        if tally is not None:
            head["tallied"], head["taken_topics"] = tally.count, tally.taken
        self.addresses += (0 if tally is None else tally.block.ctypes.data,)

    def _words(self, count: int) -> int:
        """The place, in words, of so many new ones."""
        self._block += bytes(-len(self._block) % 8 + 8 * count)
        return len(self._block) // 8 - count

    def _place(self, message: bytes) -> int:
        """The place of a message, whose numbers come to stand at whole words: they do behind the encapsulation."""
        self._block += bytes(-(len(self._block) + len(ENCAPSULATION)) % 8)
        self._block += message
        return len(self._block) - len(message)

    def frame(self, row: int) -> Frame:
        """A copy of one of the frames."""
        copied = Frame()
        copied.numbers[:] = memoryview(self.frames[row])
        return copied

    def heard(self) -> tuple[bytes, bytes]:
        """The message that was taken last, and the identity of its publisher."""
        at, sender = int(self.head["message"][0]), int(self.head["info"][0]) + GID
        message = ctypes.string_at(int(self.words[at]), int(self.words[at + 1]))
        return message, self.words[sender : sender + 2].tobytes()
