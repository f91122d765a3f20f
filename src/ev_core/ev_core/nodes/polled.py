"""A node that `spinning.spin` polls for what its next step waits for; compiled code takes its ordinary steps."""

from __future__ import annotations

from functools import cached_property

from ev_core.lockstep.stepper import Stepper
from ev_core.node_loop.message_memory import End
from ev_core.node_loop.ordinary_steps import OrdinarySteps, can_be_taken
from ev_core.nodes.reports import Reports
from ev_core.nodes.signal_io import SignalReader, SignalWriter, SubscriptionHandle
from ev_msgs_py.contract import stamps

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
        return OrdinarySteps(self, self.ends()) if can_be_taken() else None

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
