"""The memory of the compiled loop of a node (`compiling/node_steps.py`), laid out from what the node hears and says."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ev_msgs_py.compiling.node_steps import GID, HEAD, INPUT, OUTPUT, RUN
from ev_msgs_py.contract.frame import SIZE, Frame
from ev_msgs_py.nodes import rcl
from ev_msgs_py.wire.cdr import ENCAPSULATION
from ev_msgs_py.wire.message_format import MessageFormat, Run

_SENDERS = 8  # of each input: who may speak, and others who are known to be refused
_CAPACITY = 4096  # bytes of a message that need not be asked for
_NOBODY = -1


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
    """Structured arrays of one node; they must last as long as the loop may be called."""

    def __init__(self, inputs: Sequence[End], outputs: Sequence[End]) -> None:
        self._bytes = bytearray()
        self.head = np.zeros(1, HEAD)
        self.inputs, self.outputs = np.zeros(len(inputs), INPUT), np.zeros(len(outputs), OUTPUT)
        self.senders = np.full((len(inputs), _SENDERS, 2), _NOBODY)
        self.frames = np.zeros((4, SIZE))
        self.runs = np.array([tuple(run) for end in (*inputs, *outputs) for run in end.runs], RUN)
        head = self.head[0]
        for name, words in (("message", rcl.MESSAGE_WORDS), ("info", rcl.INFO_WORDS), ("clock", 2), ("count", 1)):
            head[name] = self._room(8 * words) // 8
        head["heard"] = self._place(bytes(max(len(end.template) for end in inputs)))
        run = 0
        for row, end in zip((*self.inputs, *self.outputs), (*inputs, *outputs), strict=True):
            row["template"], row["single"] = self._place(end.template), end.single
            row["first"], row["last"] = run, run + len(end.runs)
            run += len(end.runs)
        for row, end in zip(self.inputs, inputs, strict=True):
            row["subscription"], row["length"], row["mask"] = end.address, len(end.template), self._place(end.mask)
        for row, end in zip(self.outputs, outputs, strict=True):
            row["publisher"], row["message"] = end.address, self._room(8 * rcl.MESSAGE_WORDS) // 8
        self.memory = np.frombuffer(self._bytes + bytes(-len(self._bytes) % 8), np.int64).copy()
        self.here = self.memory.ctypes.data
        rcl.prepare_message(self.here + 8 * int(head["message"]), _CAPACITY)
        for row, end in zip(self.outputs, outputs, strict=True):  # without allocator: nobody makes them grow
            at, length = int(row["message"]), len(end.template)
            self.memory[at : at + 3] = self.here + int(row["template"]), length, length
        sizes = (len(inputs), len(outputs), len(self.runs), _SENDERS, SIZE, self.memory.nbytes)
        for name, size in zip(("inputs", "outputs", "runs", "senders", "width", "size"), sizes, strict=True):
            head[name] = size
        arrays = (self.head, self.inputs, self.outputs, self.runs, self.senders, self.frames, self.memory)
        self.addresses = tuple(array.ctypes.data for array in arrays)

    def _room(self, size: int) -> int:
        """The place of so many bytes, which begin with a word."""
        self._bytes += bytes(-len(self._bytes) % 8)
        place = len(self._bytes)
        self._bytes += bytes(size)
        return place

    def _place(self, message: bytes) -> int:
        """The place of a message, whose numbers come to stand at whole words: they do behind the encapsulation."""
        self._bytes += bytes(-(len(self._bytes) + len(ENCAPSULATION)) % 8)
        place = len(self._bytes)
        self._bytes += message
        return place

    def frame(self, row: int) -> Frame:
        """A copy of one of the frames."""
        copied = Frame()
        copied.numbers[:] = memoryview(self.frames[row])
        return copied

    def heard(self) -> tuple[bytes, bytes]:
        """The message that was taken last, and the identity of its publisher."""
        at, sender = int(self.head["message"][0]), int(self.head["info"][0]) + GID
        return ctypes.string_at(int(self.memory[at]), int(self.memory[at + 1])), self.memory[
            sender : sender + 2
        ].tobytes()
