"""The compiled loop of one node as Python sees it: when it may be used, its memory, its calls.

How it works: `steps` holds the loop itself. It calls functions of rcl, below rclpy, by their
addresses, and works on the inbox of the node, so that nothing is copied from one to the other.
`OrdinarySteps` lays out what the loop needs in arrays of records and in one block of memory, calls
it, and lets Python judge each message that is not an ordinary one. Without the loop
(EV_STACK_NODE_LOOP=0, another C library, no machine code on disk) nodes take all steps in Python,
with the same numbers.
"""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Sequence
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation

from ev_core.compiling.code_store import can_be_kept
from ev_core.lockstep.run import guarded, raised
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_msgs_py.refusal import ParameterError, quoted
from ev_msgs_py.wire import ENCAPSULATION
from ev_nodes.node_loop import steps
from ev_nodes.node_loop.steps import FAILED, GID, INPUT, LOOP, NOT_FINITE, ODD, OUTPUT, RUN

VARIABLE = "EV_STACK_NODE_LOOP"


def is_switched_on() -> bool:
    """Return whether nodes may use the loop.

    ParameterError if the variable of the environment is not 0 or 1.
    """
    given = os.environ.get(VARIABLE, "1")
    if given not in ("0", "1"):
        raise ParameterError(
            f"{VARIABLE}={quoted(given)} is refused, expected 1, or 0 for nodes without their loop"
        )
    return given == "1"


def can_be_taken() -> bool:
    """Return whether the loop can run: it is switched on, and finds its machine code and ROS's C library."""
    return is_switched_on() and bool(addresses()) and steps.CODE.is_kept()


def keep_code() -> None:
    """Compile the loop to disk: without it nodes take their steps at half the speed."""
    if is_switched_on() and can_be_kept() and not steps.CODE.is_kept():
        steps.CODE.address()


class End(NamedTuple):
    """A subscription or a publisher: its address, and how its messages look, as in `MessageFormat`."""

    address: int
    format: Any


# `rcutils_uint8_array_t`, and room for more than `rmw_message_info_t`, in words of 8 bytes.
MESSAGE_WORDS, INFO_WORDS = 8, 32


@cache
def addresses() -> dict[str, int]:
    """Addresses of C functions by their names in the loop.

    None on a system that names its libraries differently.
    """
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
    return {
        name: ctypes.cast(function, ctypes.c_void_p).value or 0
        for name, function in functions.items()
    }


class _Allocator(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state")
    ]


def prepare_message(address: int, capacity: int) -> None:
    """Make an `rcutils_uint8_array_t` to take messages into.

    It grows with them, and lasts until it is freed.
    """
    rcutils = ctypes.CDLL("librcutils.so")
    rcutils.rcutils_get_default_allocator.restype = _Allocator
    allocator = rcutils.rcutils_get_default_allocator()
    rcutils.rcutils_uint8_array_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    if rcutils.rcutils_uint8_array_init(address, capacity, ctypes.byref(allocator)) != 0:
        raise MemoryError(f"no {capacity} bytes for a message")


def free_message(address: int) -> None:
    """Free what `prepare_message` has made, grown as it may be."""
    ctypes.CDLL("librcutils.so").rcutils_uint8_array_fini(ctypes.c_void_p(address))


_LOOP_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 9)
# Places of fields in the record of the loop, which is read and written as a row of integers.
_PLACES = {name: place for place, name in enumerate(LOOP.names or ())}
_LIMIT = _PLACES["limit"]
_UNTIL = _PLACES["until"]
_PATIENCE = _PLACES["patience"]
_GUARD = _PLACES["guard"]
_CAME = _PLACES["came"]
_REFUSED = _PLACES["refused"]
_TAKEN = _PLACES["taken"]
_SPOKE = _PLACES["spoke"]
_ODD = _PLACES["odd"]
_FUNCTION = _PLACES["function"]
_STATE = _PLACES["state"]
_CONSTANTS = _PLACES["constants"]
_NO_SENDER = b"\xff" * 16  # no identity
_FORGET_PERIOD = 0.05  # s after which senders that are refused are looked at again
_SENDERS = 8  # of each input: the admitted one, and others that are known to be refused
CAPACITY = 4096  # bytes of a message that need not be asked for


class Block:
    """Memory in words of 8 bytes, which is put together first, and then lasts at `address`."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def words_for(self, count: int) -> int:
        """Add so many words, and return the place of the first, in words."""
        self._bytes += bytes(-len(self._bytes) % 8 + 8 * count)
        return len(self._bytes) // 8 - count

    def place_for(self, message: bytes) -> int:
        """Add a message so that its numbers are aligned to words behind its encapsulation, and return its place."""
        self._bytes += bytes(-(len(self._bytes) + len(ENCAPSULATION)) % 8)
        self._bytes += message
        return len(self._bytes) - len(message)

    def finish(self) -> None:
        """Fix the block in memory; nothing more is added."""
        self.words = np.frombuffer(self._bytes + bytes(-len(self._bytes) % 8), np.int64).copy()
        self.address = self.words.ctypes.data


class OrdinarySteps:
    """Lets the loop drive the stepper of a node.

    `outputs` are its publishers, in the order of their turns. Its arrays of records last as long as
    the loop may be called.
    """

    def __init__(self, node: Any, outputs: Sequence[End]) -> None:
        self._stepper = node.stepper
        inbox, sums = node.stepper.inbox, node.stepper.tally
        self._readers = [node.readers[kind] for kind in node.stepper.reads]
        context = node.context.handle
        with context:
            self._wait_set = rclpy_implementation.WaitSet(1, 1, 0, 0, 0, 0, context)
        inputs = [reader.end for reader in self._readers]
        self._head = np.zeros(1, LOOP)
        self._words = self._head.view(np.int64).data
        self._inputs, self._outputs = np.zeros(len(inputs), INPUT), np.zeros(len(outputs), OUTPUT)
        self._senders = np.full((len(inputs), _SENDERS, 2), -1)
        self._runs = np.array(
            [tuple(run) for end in (*inputs, *outputs) for run in end.format.runs], RUN
        )
        self._lay_out(inputs, outputs)
        head = self._head[0]
        begin, end = frame.span(node.configuration.method.writes)
        values = {
            name: value for name, value in inbox.steps._asdict().items() if isinstance(value, int)
        }
        values |= {
            "topics": len(inputs),
            "publishers": len(outputs),
            "runs": len(self._runs),
            "senders": _SENDERS,
        }
        values |= {
            "size": self._block.words.nbytes,
            "begin": begin,
            "end": end,
            "wait_set": self._wait_set.pointer,
        }
        if sums is not None:
            values["tallied"] = 1
        for name, value in (values | addresses()).items():
            head[name] = value
        arrays = (self._inputs, self._outputs, self._runs, self._senders)
        of_steps, of_frames = inbox.addresses
        arguments = (
            self._head.ctypes.data,
            of_steps,
            *(array.ctypes.data for array in arrays),
            of_frames,
            self._block.address,
            0 if sums is None else sums.block.ctypes.data,
        )
        self._call = partial(_LOOP_FUNCTION(steps.CODE.address()), *arguments)
        self._forget_at = 0.0
        self._admitted: list[bytes | None] = []
        self._part: Any = None

    def _lay_out(self, inputs: Sequence[End], outputs: Sequence[End]) -> None:
        """Put templates, messages and what functions fill in into one block."""
        block, head, run = Block(), self._head[0], 0
        for name, words in (
            ("message", MESSAGE_WORDS),
            ("info", INFO_WORDS),
            ("clock", 2),
            ("count", 1),
        ):
            head[name] = block.words_for(words)
        head["heard"] = block.place_for(bytes(max(len(end.format.template) for end in inputs)))
        for row, end in zip((*self._inputs, *self._outputs), (*inputs, *outputs), strict=True):
            form = end.format
            row["template"] = block.place_for(form.template)
            row["mask"] = block.place_for(form.mask)
            row["length"] = len(form.template)
            row["single"] = form.code == "f"
            row["first"] = run
            row["last"] = run + len(form.runs)
            numbers = {
                place for each in form.runs for place in range(each.place, each.place + each.length)
            }
            unsigned = sorted(numbers & frame.UNSIGNED_COMMANDS)
            row["unsigned"], row["signed"] = (unsigned[0], unsigned[-1] + 1) if unsigned else (0, 0)
            run += len(form.runs)
        self._inputs["subscription"] = [end.address for end in inputs]
        self._outputs["publisher"] = [end.address for end in outputs]
        self._outputs["message"] = [block.words_for(MESSAGE_WORDS) for _ in outputs]
        block.finish()
        prepare_message(block.address + 8 * int(head["message"]), CAPACITY)
        for row in self._outputs:  # without an allocator: messages that are sent do not grow
            at = int(row["message"])
            block.words[at : at + 3] = block.address + row["template"], row["length"], row["length"]
        self._block = block

    def take(self, until: float, patience: float, limit: int, guard: int) -> bool | None:
        """Take steps up to a time of the monotonic clock, a stamp, or the first pause of `patience` seconds.

        The guard condition at the address wakes it up, too. It returns whether anything has come,
        None if these steps are not for the loop: before the first step, or beyond the limit.
        """
        stepper, head = self._stepper, self._words
        if not stepper.under_way or stepper.inbox.last + stepper.period > limit:
            return None
        head[_UNTIL], head[_PATIENCE] = int(until * NANOSECONDS), int(patience * NANOSECONDS)
        head[_LIMIT], head[_GUARD] = limit, guard
        head[_CAME] = head[_TAKEN] = head[_REFUSED] = 0
        if stepper.part is not self._part:
            self._part = stepper.part
            head[_FUNCTION], head[_STATE], head[_CONSTANTS] = self._part.addresses()
        self._name_senders()
        why = guarded((self._part,), lambda: self._call())
        if head[_REFUSED]:
            for refused, reader in zip(self._inputs["refused"], self._readers, strict=True):
                reader.speaker.refused += int(refused)
            self._inputs["refused"] = 0
        if why == ODD:
            self._judge(head[_ODD])
        elif why in (FAILED, NOT_FINITE):
            due = stepper.inbox.last + stepper.period
            if why == FAILED:
                raise raised(self._part, stepper.inputs_of(due).numbers)
            self._part.refuse_not_finite(stepper.frame_of(due + stepper.inbox.steps.lead))
        return why == ODD or bool(head[_CAME])

    @property
    def taken(self) -> int:
        """Number of steps that the last call has taken."""
        return self._words[_TAKEN]

    @property
    def spoke(self) -> float:
        """Time of its last answer, on the monotonic clock [s]."""
        return self._words[_SPOKE] / NANOSECONDS

    def _name_senders(self) -> None:
        """Give the loop the identities of the admitted publishers."""
        admitted = [reader.speaker.admitted for reader in self._readers]
        if admitted != self._admitted:
            self._admitted = admitted
            for senders, gid in zip(self._senders, admitted, strict=True):
                senders[0] = np.frombuffer(gid or _NO_SENDER, np.int64)
        if time.monotonic() >= self._forget_at:
            self._forget_at = time.monotonic() + _FORGET_PERIOD
            self._senders[:, 1:] = np.frombuffer(_NO_SENDER, np.int64)

    def _judge(self, place: int) -> None:
        """Let Python judge the message that was taken last.

        For a while the loop refuses a sender that it refuses.
        """
        words = self._block.words
        at, sender = int(self._head["message"][0]), int(self._head["info"][0]) + GID
        message = ctypes.string_at(int(words[at]), int(words[at + 1]))
        gid = words[sender : sender + 2].tobytes()
        if not self._readers[place].judge(message, {"publisher_gid": {"data": gid}}):
            others = self._senders[place, 1:]
            others[:] = np.roll(others, 1, axis=0)
            others[0] = np.frombuffer(gid, np.int64)
