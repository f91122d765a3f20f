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
from collections.abc import Sequence
from functools import cache, partial
from typing import Any

import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation

from ev_core.compiling.code_store import can_be_kept
from ev_core.lockstep.run import guarded, raised
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.stamps import NANOSECONDS
from ev_msgs_py.refusal import ParameterError, quoted
from ev_msgs_py.wire import ENCAPSULATION
from ev_nodes.node_loop import steps
from ev_nodes.node_loop.steps import FAILED, INPUT, LOOP, NOT_FINITE, ODD, OUTPUT, RUN
from ev_nodes.rcl.taking import GID, INFO_WORDS, MESSAGE_WORDS, End, prepare_message, rcl

VARIABLE = "EV_STACK_NODE_LOOP"
_LOOP_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 8)
_NO_PUBLISHER = b"\xff" * 16  # no identity


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


@cache
def addresses() -> dict[str, int]:
    """Addresses of C functions by their names in the loop, none where ROS's C library is not found."""
    library = rcl()
    if library is None:
        return {}
    libc = ctypes.CDLL(None)
    functions = {
        "rcl_take": library.rcl_take_serialized_message,
        "rcl_publish": library.rcl_publish_serialized_message,
        "rcl_count": library.rcl_publisher_get_subscription_count,
        "rcl_clear": library.rcl_wait_set_clear,
        "rcl_add": library.rcl_wait_set_add_subscription,
        "rcl_add_guard": library.rcl_wait_set_add_guard_condition,
        "rcl_wait": library.rcl_wait,
        "clock_gettime": libc.clock_gettime,
        "memcpy": libc.memcpy,
    }
    return {
        name: ctypes.cast(function, ctypes.c_void_p).value or 0
        for name, function in functions.items()
    }


# Places of fields in the record of the loop, which is read and written as a row of integers.
_PLACES = {name: place for place, name in enumerate(LOOP.names or ())}
_LIMIT = _PLACES["limit"]
_UNTIL = _PLACES["until"]
_PATIENCE = _PLACES["patience"]
_GUARD = _PLACES["guard"]
_CAME = _PLACES["came"]
_TAKEN = _PLACES["taken"]
_SPOKE = _PLACES["spoke"]
_ODD = _PLACES["odd"]
_FUNCTION = _PLACES["function"]
_STATE = _PLACES["state"]
_CONSTANTS = _PLACES["constants"]


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
        self._readers = [node.readers[kind] for kind in node.stepper.reads]
        context = node.context.handle
        with context:
            self._wait_set = rclpy_implementation.WaitSet(1, 1, 0, 0, 0, 0, context)
        inputs = [reader.end for reader in self._readers]
        self._head = np.zeros(1, LOOP)
        self._words = self._head.view(np.int64).data
        self._inputs = np.zeros(len(inputs), INPUT)
        self._outputs = np.zeros(len(outputs), OUTPUT)
        self._admitted = np.full((len(inputs), 2), -1)
        runs = [tuple(run) for end in (*inputs, *outputs) for run in end.format.runs]
        self._runs = np.array(runs, RUN)
        self._lay_out(inputs, outputs)
        self._fill_in_head(frame.span(node.configuration.method.writes))
        of_steps, of_frames = node.stepper.inbox.addresses
        self._call = partial(
            _LOOP_FUNCTION(steps.CODE.address()),
            self._head.ctypes.data,
            of_steps,
            self._inputs.ctypes.data,
            self._outputs.ctypes.data,
            self._runs.ctypes.data,
            self._admitted.ctypes.data,
            of_frames,
            self._block.address,
        )
        self._gids: list[bytes | None] = []
        self._part: Any = None

    def _fill_in_head(self, written: tuple[int, int]) -> None:
        """Fill in what stays for all calls: the protocol's constants, sizes and addresses."""
        begin, end = written
        values = {
            "topics": len(self._inputs),
            "publishers": len(self._outputs),
            "runs": len(self._runs),
            "size": self._block.words.nbytes,
            "begin": begin,
            "end": end,
            "wait_set": self._wait_set.pointer,
            **addresses(),
        }
        for name, value in self._stepper.inbox.steps._asdict().items():
            if isinstance(value, int):
                values[name] = value
        for name, value in values.items():
            self._head[0][name] = value

    def _lay_out(self, inputs: Sequence[End], outputs: Sequence[End]) -> None:
        """Put templates, messages and what functions fill in into one block."""
        block, head = Block(), self._head[0]
        head["message"] = block.words_for(MESSAGE_WORDS)
        head["info"] = block.words_for(INFO_WORDS)
        head["clock"] = block.words_for(2)
        head["count"] = block.words_for(1)
        head["heard"] = block.place_for(bytes(max(len(end.format.template) for end in inputs)))
        run = 0
        for row, end in zip((*self._inputs, *self._outputs), (*inputs, *outputs), strict=True):
            form = end.format
            row["template"] = block.place_for(form.template)
            row["mask"] = block.place_for(form.mask)
            row["length"] = len(form.template)
            row["single"] = form.code == "f"
            row["first"] = run
            row["last"] = run + len(form.runs)
            run += len(form.runs)
            _mark_unsigned(row, form.runs)
        self._inputs["subscription"] = [end.address for end in inputs]
        self._outputs["publisher"] = [end.address for end in outputs]
        self._outputs["message"] = [block.words_for(MESSAGE_WORDS) for _ in outputs]
        block.finish()
        prepare_message(block.address + 8 * int(head["message"]))
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
        head[_UNTIL] = int(until * NANOSECONDS)
        head[_PATIENCE] = int(patience * NANOSECONDS)
        head[_LIMIT] = limit
        head[_GUARD] = guard
        head[_CAME] = 0
        head[_TAKEN] = 0
        if stepper.part is not self._part:
            self._part = stepper.part
            head[_FUNCTION], head[_STATE], head[_CONSTANTS] = self._part.addresses()
        self._name_publishers()
        why = guarded((self._part,), lambda: self._call())
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

    def _name_publishers(self) -> None:
        """Give the loop the identities of the admitted publishers."""
        gids = [reader.judge.admitted for reader in self._readers]
        if gids != self._gids:
            self._gids = gids
            for row, gid in zip(self._admitted, gids, strict=True):
                row[:] = np.frombuffer(gid or _NO_PUBLISHER, np.int64)

    def _judge(self, place: int) -> None:
        """Let Python judge the message that was taken last."""
        words = self._block.words
        message_at = int(self._head["message"][0])
        gid_at = int(self._head["info"][0]) + GID
        message = ctypes.string_at(int(words[message_at]), int(words[message_at + 1]))
        gid = words[gid_at : gid_at + 2].tobytes()
        self._readers[place].receive_from(gid, message)


def _mark_unsigned(row: Any, runs: Sequence[Any]) -> None:
    """Note the places of the frame that hold commands of a topic which are never negative."""
    places: set[int] = set()
    for run in runs:
        places.update(range(run.place, run.place + run.length))
    unsigned = sorted(places & frame.UNSIGNED_COMMANDS)
    if unsigned:
        row["unsigned"] = unsigned[0]
        row["signed"] = unsigned[-1] + 1
