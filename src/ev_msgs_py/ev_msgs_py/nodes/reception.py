"""What a message does in a node, apart from where it came from: judged, kept, stepped with, answered."""

from __future__ import annotations

from collections.abc import Callable

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.lockstep.inbox import Arrival
from ev_msgs_py.lockstep.stepper import Answer, Stepper
from ev_msgs_py.wire.layout import MessageError
from ev_msgs_py.wire.message_format import format_of, stamp_of

Keep = Callable[[bytes], tuple[int, Arrival] | None]


class Reception:
    """Feeds serialized messages to a stepper; `warn` is told what is odd, `publish` what there is to say."""

    def __init__(self, stepper: Stepper, warn: Callable[[str], None], publish: Callable[[Answer], None]) -> None:
        self._stepper, self._warn, self._publish = stepper, warn, publish
        self._gaps: set[Topic] = set()
        self._joined_late = False
        self._before_reset = -1  # stamp up to which late messages may still be of the run before a reset

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """A function that takes a message of a topic, steps if that completes the inputs, and answers."""
        keep, kind, answers_to, publish = self.keeper(topic), topic.signal, self._stepper.answers_to, self._publish

        def receive(message: bytes) -> None:
            kept = keep(message)
            if kept is not None:
                stamp, arrival = kept
                if arrival is Arrival.GAP:
                    self._report_gap(topic, stamp)
                for answer in answers_to(kind, stamp, arrival):
                    publish(answer)

        return receive

    def keeper(self, topic: Topic) -> Keep:
        """A function that judges and keeps a message of a topic.

        It gives stamp and judgement, or None if nothing can follow from the message. Most messages end here, so what
        it needs is at hand.
        """
        kind, how, stepper, inbox = topic.signal, format_of(topic.signal), self._stepper, self._stepper.inbox
        canonical, unpack, new = how.canonical, how.unpack, Arrival.NEW

        def keep(message: bytes) -> tuple[int, Arrival] | None:
            try:
                readable = canonical(message)
            except MessageError as error:
                return self._refuse(topic, message, error)
            stamp, last, fresh = stamp_of(readable), inbox.last, stepper.is_fresh
            arrival = stepper.offer(kind, stamp)
            if arrival is new:
                unpack(readable, inbox.frame_at(stamp))
                if stepper.lacks_inputs:
                    return None
            elif arrival is Arrival.RESTART:
                unpack(readable, inbox.frame_at(stamp))
                self._before_reset = last + 2 * stepper.period
            if fresh and stamp > 0 and not self._joined_late:
                self._joined_late = True
                self._warn(f"joined at {stamps.to_seconds(stamp)} s with a fresh state: the run is not reproducible")
            return stamp, arrival

        return keep

    def readable(self, topic: Topic, message: bytes) -> bytes | None:
        """The message in our own layout; None, and a report, if it is refused."""
        try:
            return format_of(topic.signal).canonical(message)
        except MessageError as error:
            return self._refuse(topic, message, error)

    def _refuse(self, topic: Topic, message: bytes, error: MessageError) -> None:
        self._warn(f"{topic.name}{_when(message)} ignored: {error}")

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
