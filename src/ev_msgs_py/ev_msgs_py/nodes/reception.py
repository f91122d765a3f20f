"""What a message does in a node, apart from where it came from: judged, kept, stepped with, answered."""

from __future__ import annotations

from collections.abc import Callable

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.lockstep.inbox import Arrival
from ev_msgs_py.lockstep.stepper import Answer, Stepper
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import format_of, stamp_of


class Reception:
    """Feeds serialized messages to a stepper; `warn` is told what is odd, `publish` what there is to say."""

    def __init__(self, stepper: Stepper, warn: Callable[[str], None], publish: Callable[[Answer], None]) -> None:
        self._stepper, self._warn, self._publish = stepper, warn, publish
        self._gaps: set[Topic] = set()
        self._joined_late = False
        self._before_reset = -1  # stamp up to which late messages may still be of the run before a reset

    def receive(self, topic: Topic, message: bytes) -> None:
        """Judge a message, step if that completes the inputs, answer."""
        arrived = self.keep(topic, message)
        if arrived is not None:
            stamp, arrival = arrived
            if arrival is Arrival.GAP:
                self._report_gap(topic, stamp)
            for answer in self._stepper.answers_to(topic.signal, stamp, arrival):
                self._publish(answer)

    def keep(self, topic: Topic, message: bytes) -> tuple[int, Arrival] | None:
        """Judge and keep a message; stamp and judgement, or None if nothing can follow from it."""
        readable = self.readable(topic, message)
        if readable is None:
            return None
        stamp, stepper = stamp_of(readable), self._stepper
        fresh, last = stepper.is_fresh, stepper.inbox.last
        arrival = stepper.offer(topic.signal, stamp)
        if arrival is Arrival.NEW or arrival is Arrival.RESTART:
            format_of(topic.signal).unpack(readable, stepper.inbox.frame_at(stamp))
            if arrival is Arrival.NEW and stepper.lacks_inputs:
                return None  # most messages end here
        if arrival is Arrival.RESTART and last is not None:
            self._before_reset = last + 2 * stepper.period
        if fresh and stamp > 0 and not self._joined_late:
            self._joined_late = True
            self._warn(f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not reproducible")
        return stamp, arrival

    def readable(self, topic: Topic, message: bytes) -> bytes | None:
        """The message in our own layout; None, and a report, if it is refused."""
        try:
            return format_of(topic.signal).canonical(message)
        except MessageError as error:
            self._warn(f"{topic.name}{_when(message)} ignored: {error}")
            return None

    def _report_gap(self, topic: Topic, stamp: int) -> None:
        if topic in self._gaps or stamp <= self._before_reset:
            return
        self._gaps.add(topic)
        due = stamps.to_seconds(self._stepper.inbox.last + self._stepper.period)
        self._warn(f"{topic.name} at {stamps.to_seconds(stamp)} s ignored (reported once): {due} s is due")


def _when(message: bytes) -> str:
    """The instant of a message in words, as far as it can be read."""
    try:
        return f" at {stamps.to_seconds(stamp_of(message))} s"
    except MessageError:
        return ""
