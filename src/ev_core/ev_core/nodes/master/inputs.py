"""What the master does with a message: it answers none, but goes on where it may."""

from __future__ import annotations

from collections.abc import Callable

from ev_core.lockstep.inbox import Arrival, Inbox
from ev_core.nodes.master.schedule import Schedule
from ev_core.nodes.reception import Reception
from ev_msgs_py.contract.roles import RECORDER_WRITES
from ev_msgs_py.contract.topics import Topic


class MasterInputs:
    """Makes the functions that take messages; `go_on` is called when time may advance."""

    def __init__(self, reception: Reception, inbox: Inbox, schedule: Schedule, go_on: Callable[[], None]) -> None:
        self._reception, self._inbox, self._schedule, self._go_on = reception, inbox, schedule, go_on

    def receiver(self, topic: Topic) -> Callable[[bytes], None]:
        """Takes an input of the next step or, in real time, the newest; or notes how far the recorder is."""
        if topic.signal is RECORDER_WRITES:
            return self._of_the_recorder(topic)
        return self._held(topic) if self._schedule.realtime else self._of_a_step(topic)

    def _of_a_step(self, topic: Topic) -> Callable[[bytes], None]:
        kind, read, offer, go_on = topic.signal, self._reception.reader(topic), self._inbox.offer, self._go_on
        arrivals = self._reception.arrivals

        def take(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                arrival = offer(kind, *readable)
                if arrival is Arrival.NEW:
                    go_on()
                else:
                    arrivals[arrival] += 1

        return take

    def _held(self, topic: Topic) -> Callable[[bytes], None]:
        read = self._reception.reader(topic)

        def hold(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                self._schedule.hold(topic.signal, *readable)
            self._go_on()  # a step that is due waits for no pause between messages

        return hold

    def _of_the_recorder(self, topic: Topic) -> Callable[[bytes], None]:
        read = self._reception.reader(topic)

        def note(message: bytes) -> None:
            readable = read(message)
            if readable is not None:
                self._schedule.note_recorded(readable[0])
                self._go_on()

        return note
