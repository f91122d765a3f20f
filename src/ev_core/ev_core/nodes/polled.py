"""A node that `spinning.spin` polls for what its next step waits for; compiled code takes its ordinary steps."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation

from ev_core.lockstep.stepper import Answer, Stepper
from ev_core.node_loop import memory, records
from ev_core.node_loop.memory import End, StepMemory
from ev_core.node_loop.steps import FAILED, NOT_FINITE, ODD
from ev_core.nodes.reports import Reports
from ev_core.nodes.signal_io import SignalReader, SignalWriter, SubscriptionHandle
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import INTEGRATED, MASTER
from ev_msgs_py.contract.stamps import NANOSECONDS

_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 8)
_NOBODY = b"\xff" * 16  # no identity
_FORGET_PERIOD = 0.05  # s after which senders that are refused are looked at again


class OrdinarySteps:
    """Drives the stepper of a node; `outputs` are its publishers, in the order in which they shall speak."""

    def __init__(self, node: Any, outputs: Sequence[End]) -> None:
        self._stepper = node.stepper
        self._kinds = node.stepper.reads
        self._readers = [node.readers[kind] for kind in self._kinds]
        context = node.context.handle
        with context:
            self._wait_set = rclpy_implementation.WaitSet(1, 1, 0, 0, 0, 0, context)
        self._memory = StepMemory([reader.end for reader in self._readers], outputs, node.stepper.tally)
        self._call = _FUNCTION(records.address())
        self._forget_at = 0.0
        method = node.configuration.method
        told = dict(zip(("begin", "end"), frame.span(method.writes), strict=True))
        told |= {"period": self._stepper.period, "integrates": self._stepper.integrates}
        told |= {"wait_set": self._wait_set.pointer, **memory.addresses()}
        for name, value in told.items():
            self._memory.head[name] = value
        self._memory.inputs["followed"] = [method.role == MASTER and kind in INTEGRATED for kind in self._kinds]

    @staticmethod
    def possible() -> bool:
        """Whether what it takes is there: the loop's machine code, and ROS's C library."""
        return bool(memory.addresses()) and records.is_kept()

    def take(self, until: float, patience: float, limit: int, guard: int) -> bool:
        """Take steps up to a time of the monotonic clock, a stamp, or the first pause of `patience` seconds.

        The guard condition at the address wakes it up, too. False if that is not for the loop to do: before the first
        step, or beyond the limit.
        """
        inbox = self._stepper.inbox
        if not self._stepper.under_way:
            return False
        due = inbox.last + inbox.period
        if due > limit or not inbox.pending.keys() <= {due, due + inbox.period}:
            return False
        head, part = self._memory.head[0], self._stepper.part
        head["until"], head["patience"], head["limit"] = int(until * NANOSECONDS), int(patience * NANOSECONDS), limit
        head["guard"] = guard
        head["function"], head["state"], head["constants"] = part.addresses()
        self._hand_over(head)
        if self._stepper.tally is not None:
            self._stepper.tally.settle()
        why = self._call(*self._memory.addresses)
        self._take_back(head)
        if why == ODD:
            self._judge(int(head["odd"]))
        elif why == FAILED:
            raise part.error
        elif why == NOT_FINITE:
            part.refuse_not_finite(self._memory.frame(int(head["said"])))
        return True

    @property
    def taken(self) -> int:
        """How many steps it has taken the last time."""
        return int(self._memory.head["taken"][0])

    @property
    def spoke(self) -> float:
        """When it has spoken last, on the monotonic clock."""
        return float(self._memory.head["spoke"][0]) / NANOSECONDS

    def _hand_over(self, head: Any) -> None:
        """Tell the loop what has come, and who may speak."""
        inbox, memory = self._stepper.inbox, self._memory
        head["due"], head["run"], head["row"], head["taken"] = inbox.last + inbox.period, inbox.run, 0, 0
        for row, came in enumerate(("came", "came_next")):
            numbers, kinds = inbox.pending.get(inbox.last + (1 + row) * inbox.period, (None, ()))
            memory.inputs[came] = [kind in kinds for kind in self._kinds]
            if numbers is not None:
                memory.frames[row] = numbers.numbers
        for senders, reader in zip(memory.senders, self._readers, strict=True):
            senders[0] = np.frombuffer(reader.speaker.admitted or _NOBODY, np.int64)
        if time.monotonic() >= self._forget_at:
            self._forget_at = time.monotonic() + _FORGET_PERIOD
            memory.senders[:, 1:] = np.frombuffer(_NOBODY, np.int64)

    def _take_back(self, head: Any) -> None:
        """Tell stepper and inbox what has been done."""
        stepper, memory = self._stepper, self._memory
        due, row, period = int(head["due"]), int(head["row"]), stepper.period
        pending = {}
        for at, stamp, came in ((row, due, "came"), (1 - row, due + period, "came_next")):
            kinds = {kind for kind, there in zip(self._kinds, memory.inputs[came], strict=True) if there}
            if kinds:
                pending[stamp] = memory.frame(at), kinds
        stepper.inbox.go_on(due - period, pending)
        if head["taken"]:
            if stepper.integrates:
                stepper.before = stepper.answer if head["taken"] == 1 else Answer(due - period, memory.frame(2 + row))
            stepper.answer = Answer(due if stepper.integrates else due - period, memory.frame(int(head["said"])))
        for refused, reader in zip(memory.inputs["refused"], self._readers, strict=True):
            reader.speaker.refused += int(refused)
        memory.inputs["refused"] = 0

    def _judge(self, place: int) -> None:
        """Let Python see to what has come; who is refused, is refused by the loop for a while."""
        message, gid = self._memory.heard()
        if not self._readers[place].judge(message, {"publisher_gid": {"data": gid}}):
            others = self._memory.senders[place, 1:]
            others[:] = np.roll(others, 1, axis=0)
            others[0] = np.frombuffer(gid, np.int64)


_LOOK_PERIOD = 0.02  # s of wall time between looks for what nobody waits for: repetitions of messages


class Polled:
    """Takes messages from its `readers`; `wanted` says which of them the next step waits for."""

    readers: dict[type, SignalReader]
    writers: dict[type, SignalWriter]
    reports: Reports
    stepper: Stepper

    @property
    def realtime(self) -> bool:
        """Whether the wall clock drives the graph, so that steps may be skipped."""
        raise NotImplementedError

    def wanted(self) -> tuple[type, ...]:
        """The signals that the next step waits for, in the order of their arrival."""
        raise NotImplementedError

    def poll(self) -> bool:
        """Take what the next step waits for and step where that completes the inputs; False if nothing was there."""
        progressed = False
        for signal in self.wanted():
            reader = self.readers[signal]
            message = reader.take()
            if message is not None:
                reader.receive(message)
                progressed = True
        return progressed

    def take_steps(self, until: float, guard: int) -> bool:
        """Let compiled code take ordinary steps up to a time of the monotonic clock; False if it cannot."""
        limit, ordinary = self.free_until(), self._ordinary
        if limit < 0 or ordinary is None or not ordinary.take(until, self.wake_up_within(), limit, guard):
            return False
        if ordinary.taken:
            self.went_on(ordinary.spoke)
        return True

    @cached_property
    def _ordinary(self) -> OrdinarySteps | None:
        return OrdinarySteps(self, self.ends()) if OrdinarySteps.possible() else None

    def free_until(self) -> int:
        """The last stamp up to which the messages alone decide when a step is taken; -1 if there is none."""
        return -1 if self.realtime else stamps.LAST_EXACT

    def ends(self) -> list[End]:
        """The publishers of what it says in a step."""
        return [writer.end for writer in self.writers.values()]

    def went_on(self, spoke: float) -> None:
        """Called when steps were taken, with the time on the monotonic clock at which it spoke last."""
        self.reports.pass_on_now_and_then(self.stepper.part)

    def sweep(self) -> None:
        """Take everything: what nobody waits for are repetitions, and they tell that somebody misses an answer."""
        for reader in self.readers.values():
            while (message := reader.take()) is not None:
                reader.receive(message)

    def awaits(self) -> SubscriptionHandle:
        """The subscription to wake up for: of the inputs that are missing, or of all, the one that arrives last."""
        return self.readers[(self.wanted() or tuple(self.readers))[-1]].handle

    def wake_up_within(self) -> float:
        """Seconds after which the node wants to be polled though no message has come."""
        return _LOOK_PERIOD

    def idle(self) -> None:
        """Called when there is nothing to take."""

    def close(self) -> None:
        """Called at the end of the process."""
