"""Keeps a whole run: every message in a bag as it came, every number in an array."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ev_msgs_py import stamps
from ev_msgs_py.topics import QUEUE_DEPTH, Topic
from ev_sim.recording.cdr_template import CdrTemplate, stamp_of
from ev_sim.recording.durable_bag import DurableBag
from ev_sim.recording.recording import Recording


class RunRecorder:
    """Collects the serialized messages of the recorded topics, one per topic and step.

    `names` are the full topic names by which the bag knows the topics; `period` is the step in nanoseconds. Without a
    `bag` directory only the arrays are kept.
    """

    def __init__(self, topics: Sequence[Topic], names: Sequence[str], period: int, bag: Path | None) -> None:
        self._topics = tuple(topics)
        self._period = period
        self._messages: list[list[bytes]] = [[] for _ in topics]
        self.bag = DurableBag(bag) if bag is not None else None
        self._handles = [
            self.bag.add_topic(name, topic.codec.message_type, depth=QUEUE_DEPTH) if self.bag is not None else None
            for topic, name in zip(topics, names, strict=True)
        ]
        self._beside: dict[str, object] = {}
        self.lost: list[str] = []

    def add(self, index: int, message: bytes) -> None:
        """Keep a message of the topic with this index; one that repeats an earlier stamp adds nothing."""
        kept = self._messages[index]
        step = stamp_of(message) // self._period
        if step < len(kept):
            return
        if step > len(kept):
            if kept:  # before its first message a topic is not yet connected, and the first step is repeated until it is
                self._note_loss(index, len(kept), step)
            return
        kept.append(message)
        if self.bag is not None:
            self.bag.write(self._handles[index], step * self._period, message)

    def add_beside(self, name: str, message_type: str, message: bytes, stamp: int) -> None:
        """Put a message that is no signal of the contract, such as /clock, into the bag only."""
        if self.bag is None:
            return
        if name not in self._beside:
            self._beside[name] = self.bag.add_topic(name, message_type)
        self.bag.write(self._beside[name], stamp, message)

    def _note_loss(self, index: int, due: int, came: int) -> None:
        if not self.lost:
            first, last = (stamps.to_seconds(step * self._period) for step in (due, came))
            self.lost.append(f"{self._topics[index].name}: {first} s is missing, {last} s came")

    @property
    def held(self) -> int:
        """Stamp up to which every topic is held, in nanoseconds; negative before the first step is complete."""
        return (min(len(messages) for messages in self._messages) - 1) * self._period

    def recording(self) -> Recording:
        """All complete steps as arrays."""
        steps = self.held // self._period + 1
        channels = {}
        for topic, messages in zip(self._topics, self._messages, strict=True):
            rows = CdrTemplate(topic).numbers(messages[:steps])
            channels.update(zip(topic.channels, rows.T, strict=True))
        time = np.array([stamps.to_seconds(step * self._period) for step in range(steps)])
        return Recording(time, channels)

    def close(self) -> None:
        """Finish the bag."""
        if self.bag is not None:
            self.bag.close()
