"""The common part of all nodes of the graph: parameters, topics, and a part that is stepped by stamps.

`spinning.spin` polls such a node for the inputs that its next step waits for; compiled code takes
its ordinary steps.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rclpy.node import Node

from ev_core.lockstep.configuration import Configuration, configure, refuse_idle
from ev_core.lockstep.graph import polling_order
from ev_core.lockstep.parts import hand_over, is_compiled, part_of
from ev_core.lockstep.stepper import WRITERS, Answer, Stepper, arrival_place
from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.former_names import note_on
from ev_core.methods.part import Part
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER, ROLES
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_nodes.rcl.taking import End
from ev_nodes.stepping import ros_parameters
from ev_nodes.stepping.reception import Reception
from ev_nodes.stepping.reports import Health, Reports
from ev_nodes.stepping.runner_line import Waiting
from ev_nodes.stepping.signal_io import SignalReader, SignalWriter, SubscriptionHandle
from ev_nodes.stepping.spinning import Spinnable

_LOOK_PERIOD = 0.02  # s of wall time between looks for messages that no step waits for: repetitions
_CURRENT_AND_FUTURE = 1 | 2  # of mlockall
_POLLING_ORDER = polling_order(ROLES, MASTER)


class SteppedNode(Spinnable, Node):
    """Plays a role: steps its part once per stamp and answers with the same stamp.

    `spinning` runs it. ParameterError or ValueError if the parameters that it is given are refused;
    the node does not exist then.
    """

    extra_parameters: type | None = None

    def __init__(self, role: str, **node_arguments: Any) -> None:
        super().__init__(
            role, automatically_declare_parameters_from_overrides=True, **node_arguments
        )
        given = ros_parameters.given(self, node_arguments)
        configuration = configure(role, given, self.extra_parameters)
        self.configuration = configuration
        self.polling_place = _POLLING_ORDER.index(role)
        self.reports = Reports(self, role)
        ros_parameters.follow(self, configuration.entries(), self._take_over)
        if not self.realtime and (loop := node_loop()):
            loop.keep_code()
        self.stepper = Stepper(
            configuration.method,
            lambda: self.new_part(self.configuration),
            configuration.period,
            self.realtime,
        )
        self.reception = Reception(self.stepper, self.reports, self.publish)
        writes = sorted(configuration.method.writes, key=arrival_place)
        self.writers = {signal: SignalWriter(self, TOPICS[signal]) for signal in writes}
        self.readers: dict[type, SignalReader] = {}
        for signal in self.also_reads(self.stepper.reads):
            reader = SignalReader(self, TOPICS[signal], self.receiver(TOPICS[signal]), self.reports)
            if WRITERS.get(signal) == MASTER:
                reader.judge.succeeded = self.reception.note_new_master
            self.readers[signal] = reader
        self.health = Health(self)
        self._waiting = Waiting(self.reports.runner)
        for lacking in ask_for(configuration.common):
            self.reports.note(lacking, lacking)
        if note := note_on(role, given):
            self.get_logger().warning(note)
        if configuration.unused:
            names = ", ".join(configuration.unused)
            self.get_logger().info(f"method {configuration.method.name} does not use: {names}")

    @property
    def realtime(self) -> bool:
        """True if the wall clock drives the graph, so that steps may be skipped."""
        return self.configuration.common.mode == "realtime"

    def new_part(self, configuration: Configuration, may_wait: bool = True) -> Part:
        """A part that plays the role, at rest, compiled first where that `may_wait`.

        Raises ValueError if it cannot.
        """
        return part_of(configuration, compiled=is_compiled(configuration, may_wait))

    def also_reads(self, reads: tuple[type, ...]) -> tuple[type, ...]:
        """The signals to subscribe to, by default those that the method reads."""
        return reads

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Function that takes the serialized messages of a topic."""
        return self.reception.receiver(topic)

    def publish(self, answer: Answer) -> None:
        """Publish an answer."""
        for writer in self.writers.values():
            writer.write(answer.stamp, answer.frame)
        self.reports.pass_on_now_and_then(self.stepper.part)

    def successor(self, configuration: Configuration, changed: Iterable[str] = ()) -> Part:
        """Part that goes on with other parameters.

        It takes over the state of a part that has published already.
        """
        part = self.new_part(configuration, may_wait=not self.realtime)
        if self.stepper.answer is not None:
            hand_over(self.stepper.part, part, changed)
        return part

    def _take_over(self, given: dict[str, Any]) -> None:
        """Go on with other parameters."""
        refuse_idle(given, self.configuration)
        before, after = self.configuration, self.configuration.changed(given)
        part = self.successor(after, given)
        self.configuration = after
        lasts = before.parameters, before.sensors, before.faults
        if (after.parameters, after.sensors, after.faults) != lasts:
            self.stepper.part = part
            self.reports.warn(f"parameters changed to {given}: the run is not reproducible")
        self.reconfigured()

    def reconfigured(self) -> None:
        """Called when new parameter values are taken over."""

    def idle(self) -> None:
        """Report to the runner the nodes that the next step waits for, none before its time.

        In real time nothing.
        """
        if not self.realtime:
            self.report_waiting(self.stepper.inbox.last, self.wanted())

    def report_waiting(self, at: object, missing: tuple[type, ...]) -> None:
        """Report that the node waits for these signals where it is, if it has been there for a while, and why."""
        whom = [WRITERS.get(signal, RECORDER) for signal in missing]
        self._waiting.look(at, whom, lambda: self.why_it_waits(missing) if missing else [])

    def why_it_waits(self, missing: tuple[type, ...]) -> list[str]:
        """List what is wrong with the messages of these signals that have arrived."""
        ignored = self.reception.ignored
        return [ignored[signal] for signal in missing if signal in ignored]

    def close(self) -> None:
        """Report the notes of the part on its last steps."""
        if self.stepper.answer is not None:
            self.reports.pass_on(self.stepper.part)
        self.reports.runner.close()

    def wanted(self) -> tuple[type, ...]:
        """The signals that the next step waits for.

        In real time all: a step that lacks one will not be taken.
        """
        return self.stepper.reads if self.realtime else self.stepper.inbox.missing()

    def poll(self) -> bool:
        """Take what the next step waits for and step where that completes the inputs.

        False if nothing was there.
        """
        progressed = self._take_ordinary(0.0, 0.0, 0)
        if progressed is not None:
            return progressed
        progressed = False
        for signal in self.wanted():
            reader = self.readers[signal]
            message = reader.take()
            if message is not None:
                reader.receive(message)
                progressed = True
        return progressed

    def take_steps(self, until: float, guard: int) -> bool:
        """Let compiled code take ordinary steps up to a time of the monotonic clock.

        False if it cannot.
        """
        return self._take_ordinary(until, self.wake_up_within(), guard) is not None

    def _take_ordinary(self, until: float, patience: float, guard: int) -> bool | None:
        """Take ordinary steps up to the first pause of `patience` seconds.

        It returns whether a message has come, None if compiled code cannot take these steps.
        """
        limit, ordinary = self.free_until(), self._ordinary
        if limit < 0 or ordinary is None:
            return None
        came: bool | None = ordinary.take(until, patience, limit, guard)
        if came and ordinary.taken:
            self.went_on(ordinary.spoke)
        return came

    @cached_property
    def _ordinary(self) -> Any:
        """The compiled loop of this node, None without it: then it takes all steps in Python."""
        loop = node_loop()
        return loop.OrdinarySteps(self, self.ends()) if loop and loop.can_be_taken() else None

    def free_until(self) -> int:
        """The last stamp up to which the messages alone decide when a step is taken.

        -1 if there is none.
        """
        return -1 if self.realtime else stamps.LAST_EXACT

    def ends(self) -> list[End]:
        """The publishers of its outputs in a step."""
        return [writer.end for writer in self.writers.values()]

    def went_on(self, spoke: float) -> None:
        """Called when steps were taken, with the time on the monotonic clock at which it published last."""
        self.reports.pass_on_now_and_then(self.stepper.part)

    def sweep(self) -> None:
        """Take all messages: by a repetition, which no step waits for, another node asks for an answer again."""
        for reader in self.readers.values():
            while (message := reader.take()) is not None:
                reader.receive(message)

    def awaits(self) -> SubscriptionHandle | None:
        """The subscription to wake up for: of the inputs that are missing the one that arrives last.

        None if the next step lacks nothing but its time: a message that `poll` leaves untaken would
        end each rest.
        """
        wanted = self.wanted()
        return self.readers[wanted[-1]].handle if wanted else None

    def wake_up_within(self) -> float:
        """Seconds after which the node wants to be polled though no message has come."""
        return _LOOK_PERIOD


def node_loop() -> Any:
    """The compiled loop of nodes, None if its room is left out: it makes steps faster and changes no number."""
    if find_spec("ev_nodes.node_loop") is None:
        return None
    return import_module("ev_nodes.node_loop.ordinary_steps")


def ask_for(p: CommonParameters) -> Iterator[str]:
    """Ask for priority and memory for all threads of this process.

    One line for each that is not granted.
    """
    if p.scheduling_priority:
        try:
            for thread in Path("/proc/self/task").iterdir():
                # One of the middleware's may end between the look and the request.
                with suppress(ProcessLookupError):
                    os.sched_setscheduler(
                        int(thread.name), os.SCHED_FIFO, os.sched_param(p.scheduling_priority)
                    )
        except OSError as error:
            yield (
                f"SCHED_FIFO with priority {p.scheduling_priority} is not granted"
                f" ({error.strerror}): needed is CAP_SYS_NICE, or rtprio in"
                " /etc/security/limits.conf"
            )
    if p.lock_memory and ctypes.CDLL(None, use_errno=True).mlockall(_CURRENT_AND_FUTURE):
        yield (
            f"locked memory is not granted ({os.strerror(ctypes.get_errno())}): "
            "needed is CAP_IPC_LOCK, or memlock in /etc/security/limits.conf"
        )
