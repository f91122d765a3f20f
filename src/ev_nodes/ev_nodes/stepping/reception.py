"""Reception of messages in a node, wherever they come from: judged, kept, stepped with, answered."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ev_core.lockstep.inbox import NEVER, Arrival
from ev_core.lockstep.stepper import Answer, Stepper
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.wire import MessageError, format_of, stamp_of
from ev_nodes.stepping.reports import Reports

_PROCESS = 12  # first bytes of an identity, which all publishers of a process have


class Reception:
    """Feeds serialized messages to a stepper.

    `reports` is given what is odd, `publish` each answer.
    """

    def __init__(
        self, stepper: Stepper, reports: Reports, publish: Callable[[Answer], None]
    ) -> None:
        self._stepper, self._reports, self._publish = stepper, reports, publish
        self.arrivals = dict.fromkeys(Arrival, 0)  # of messages that were not just kept
        self.refused = 0  # messages that could not be read, or that the topic table does not allow
        # By signal, the report on the first message that was of no use.
        self.ignored: dict[type, str] = {}
        self._gaps: set[Topic] = set()
        self._joined_late = False
        self._new_master = b""

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Return a function that takes a message of a topic, steps if that completes the inputs, and answers."""
        kind, read, publish = topic.signal, format_of(topic.signal).read, self._publish
        stepper, inbox, new = self._stepper, self._stepper.inbox, Arrival.NEW

        def receive(message: bytes) -> None:
            try:
                stamp, numbers = read(message)
            except MessageError as error:
                self.refuse(topic, message, error)
                return
            fresh = stepper.answered == NEVER
            arrival = inbox.offer(kind, stamp, numbers)
            if arrival is not new:
                self.arrivals[arrival] += 1
                if arrival is Arrival.GAP:  # which cannot belong to the run
                    self.report_gap(topic, stamp)
            for answer in stepper.answers_to(kind, stamp, arrival):
                publish(answer)
                if fresh:
                    self._note_beginning(stamp)

        return receive

    def _note_beginning(self, stamp: int) -> None:
        """Report a first answer that is not that of the beginning of a run."""
        if stamp >= self._stepper.period and not self._joined_late:
            self._joined_late = True
            self._reports.warn(
                f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not"
                " reproducible"
            )

    def note_new_master(self, gid: bytes) -> None:
        """Report a new master at time zero: its first state has the stamp of that of the master before."""
        before, self._new_master = self._new_master, gid[:_PROCESS]
        if self._stepper.inbox.is_at_zero and self._new_master != before:
            self._reports.warn(
                f"{MASTER} was started again at 0 s, its earlier state of 0 s may still count: "
                "the run is not reproducible before a reset"
            )

    def reader(self, topic: Topic) -> Callable[[bytes], tuple[int, Sequence[float]] | None]:
        """Return a function that reads stamp and numbers of a topic's message.

        None, and a report, if it is refused.
        """
        read = format_of(topic.signal).read

        def try_to_read(message: bytes) -> tuple[int, Sequence[float]] | None:
            try:
                return read(message)
            except MessageError as error:
                self.refuse(topic, message, error)
                return None

        return try_to_read

    def refuse(self, topic: Topic, message: bytes, error: MessageError) -> None:
        """Count a message that is ignored, and report the first of each topic."""
        self.refused += 1
        text = f"{topic.name}{_when(message)} ignored: {error}"
        self.ignored.setdefault(topic.signal, text)
        self._reports.note(topic.name, text)

    def report_gap(self, topic: Topic, stamp: int) -> None:
        """Report a message with a stamp that cannot belong to the run, once for each topic."""
        if topic in self._gaps:
            return
        self._gaps.add(topic)
        last, period = self._stepper.inbox.last, self._stepper.period
        if last is None:  # any step may be the first
            due = f"a multiple of {stamps.to_seconds(period)} s is expected"
        else:
            due = (
                f"{stamps.to_seconds(last + period)} s is due, in steps of"
                f" {stamps.to_seconds(period)} s"
            )
        text = f"{topic.name} at {stamps.to_seconds(stamp)} s ignored (reported once): {due}"
        self.ignored.setdefault(topic.signal, text)
        self._reports.warn(text)


def _when(message: bytes) -> str:
    """The instant of a message in words, as far as it can be read."""
    try:
        return f" at {stamps.to_seconds(stamp_of(message))} s"
    except MessageError:
        return ""
