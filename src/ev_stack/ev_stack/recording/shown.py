"""Views in a bag beside the signals: topics of their own for viewers, some times a second."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np
from rosbags.interfaces import Connection

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.topics import Topic
from ev_stack.recording.bag_writer import BagWriter
from ev_stack.recording.recording import Recording, recording_of

# A wheel turns by less than half a turn between two up to 157 rad/s: viewers turn it the right way
# between them.
VIEW_PERIOD = 0.02  # s
_AT_ONCE = 25  # instants, which cost hardly more than one


@dataclass(frozen=True, slots=True)
class View:
    """A topic for viewers, relative ones in the namespace of the graph.

    One that lasts is kept for viewers that join later.
    """

    name: str
    message_type: str
    lasts: bool = False

    def within(self, namespace: str) -> View:
        """The same with its full name."""
        return (
            self
            if self.name.startswith("/")
            else replace(self, name=f"{namespace.rstrip('/')}/{self.name}")
        )


class Message(NamedTuple):
    """A serialized message of a view."""

    view: View
    data: bytes


class Shown(Protocol):
    """Views of a run."""

    def lasting(self) -> Iterable[Message]:
        """Once, at the beginning."""

    def moving(self, stamps_ns: np.ndarray, run: Recording) -> Iterable[tuple[View, list[bytes]]]:
        """Views at instants with these stamps [ns] (n,), from the recording of them."""


class ViewsInBag:
    """Writes what is shown of a run with this step [ns] into a bag, at instants `VIEW_PERIOD` apart."""

    def __init__(self, bag: BagWriter, shown: Shown, topics: Sequence[Topic], period: int) -> None:
        self._bag, self._shown, self._topics, self._period = bag, shown, topics, period
        self._every = max(round(VIEW_PERIOD / stamps.to_seconds(period)), 1)
        self._handles: dict[View, Connection] = {}
        # by step: when it came, and its frame
        self._waiting: dict[int, tuple[int, np.ndarray]] = {}
        self._newest = np.zeros(frame.SIZE)

    def take(self, step: int, place: slice, numbers: Sequence[float], came: int) -> None:
        """Numbers of a step at their place in the frame.

        `came` is the time that the bag has for it [ns].
        """
        if step % self._every:
            return
        # What comes later in a step overwrites it there; a topic that is late shows its last
        # numbers.
        self._newest[place] = numbers
        if step not in self._waiting:
            self._waiting[step] = came, self._newest.copy()
        self._waiting[step][1][place] = numbers

    def write(self, complete: int, few: bool = True) -> None:
        """Write the steps below this one; not yet if they are `few`."""
        due = [step for step in self._waiting if step < complete]
        # Many at once cost hardly more than one: a template is filled by arrays.
        if not due or (few and len(due) < _AT_ONCE):
            return
        came, frames = zip(*map(self._waiting.pop, due), strict=True)
        self._write(np.array(due), came, recording_of(np.stack(frames), self._topics))

    def write_all(self, run: Recording) -> None:
        """Write all steps of a run that is over."""
        steps = np.arange(0, len(run.time), self._every)
        channels = {name: values[:: self._every] for name, values in run.channels.items()}
        self._write(
            steps, (steps * self._period).tolist(), Recording(run.time[:: self._every], channels)
        )

    def _write(self, steps: np.ndarray, came: Sequence[int], run: Recording) -> None:
        if not self._handles:
            for view, data in self._shown.lasting():
                self._bag.write(self._handle(view), came[0], data)
        for view, messages in self._shown.moving(steps * self._period, run):
            handle = self._handle(view)
            for at, message in zip(came, messages, strict=True):
                self._bag.write(handle, at, message)

    def _handle(self, view: View) -> Connection:
        if view not in self._handles:
            self._handles[view] = self._bag.add_topic(
                view.name, view.message_type, lasts=view.lasts
            )
        return self._handles[view]
