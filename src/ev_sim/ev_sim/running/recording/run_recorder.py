"""Keeps a whole run: every message in a bag as it came, every number in an array."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.contract.topics import QUEUE_DEPTH, Topic
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_msgs_py.wire.message_format import stamp_of
from ev_sim.running.recording.durable_bag import DurableBag
from ev_sim.running.recording.message_table import MessageTable
from ev_sim.running.recording.recording import Recording, recording_of


class RunRecorder:
    """Collects the serialized messages of the recorded topics, one per topic and step.

    `names` are the full topic names by which the bag knows the topics; `period` is the step in nanoseconds. Without a
    `bag` directory only the arrays are kept. With `may_skip` (realtime) a step that never comes holds the one before,
    and the run is as far as its master; without, it is as far as its slowest topic, and a missing step is a loss.
    Nothing behind the stamp `last` is kept: an integrating node is one step ahead of the end.

    When the master goes back to step zero (reset), a new run begins: the arrays begin anew, and so does the bag, the
    one before is kept beside it.
    """

    def __init__(
        self,
        topics: Sequence[Topic],
        names: Sequence[str],
        period: int,
        bag: Path | None,
        may_skip: bool = False,
        last: int | None = None,
    ) -> None:
        self._topics = tuple(topics)
        self._names = tuple(names)
        self._period = period
        self._may_skip = may_skip
        self._steps = float("inf") if last is None else last // period + 1
        self._messages: list[list[bytes]] = [[] for _ in topics]
        self._masters = {i for i, topic in enumerate(topics) if topic.signal in ROLES[MASTER].writes}
        self._pacing = [self._messages[i] for i in self._masters] if may_skip else self._messages
        self._directory = bag
        self._resets = 0
        self._stale = False  # whether messages of the run before a reset may still come
        self._begin_bag()
        self.loss = ""
        self.asked = False  # whether the master has repeated itself: it may wait for the recorder

    def _begin_bag(self) -> None:
        self._bag = DurableBag(self._directory) if self._directory is not None else None
        self._handles = [
            self._bag.add_topic(name, topic.message_type, depth=QUEUE_DEPTH) if self._bag is not None else None
            for topic, name in zip(self._topics, self._names, strict=True)
        ]
        self._beside: dict[str, object] = {}

    def add(self, index: int, message: bytes, came: int) -> None:
        """Keep a message of the topic with this index; one that repeats an earlier stamp adds nothing.

        In real time the bag has it under the wall time at which it came [ns], in lockstep under its stamp.
        """
        kept = self._messages[index]
        step = stamp_of(message) // self._period
        if step == 0 and index in self._masters and (len(kept) > 1 or (kept and message != kept[0])):
            self._begin_anew()
        if step >= self._steps or step < len(kept) or (self._stale and index not in self._masters):
            self.asked = self.asked or index in self._masters
            return
        if self._may_skip and index not in self._masters and step > min(map(len, self._pacing)) + 1:
            return  # nobody can be ahead of the master by more than one step: a stranger's stamp
        if step > len(kept):
            if self._may_skip:
                kept.extend([kept[-1] if kept else message] * (step - len(kept)))
            else:
                if kept:  # before its first message a topic is not connected yet; the master repeats the first step
                    self._note_loss(index, len(kept), step)
                return
        kept.append(message)
        if self._bag is not None:
            self._bag.write(self._handles[index], came if self._may_skip else step * self._period, message)

    def _begin_anew(self) -> None:
        for kept in self._messages:
            kept.clear()
        self.loss = ""
        self._stale = True
        self._resets += 1
        if self._bag is not None:
            self._bag.close()
            self._directory.rename(self._directory.with_name(f"{self._directory.name}_before_reset_{self._resets}"))
            self._begin_bag()

    def took_all(self) -> None:
        """To be called when every message that had arrived was added: those of the run before a reset are gone."""
        self._stale = False

    def _note_loss(self, index: int, due: int, came: int) -> None:
        first, last = (stamps.to_seconds(step * self._period) for step in (due, came))
        self.loss = f"{self._topics[index].name} at {first} s did not come, but {last} s did"

    def add_beside(self, name: str, message_type: str, message: bytes, stamp: int, came: int) -> None:
        """Put a message that is no signal of the contract, such as /clock, into the bag only."""
        if self._bag is None:
            return
        if name not in self._beside:
            self._beside[name] = self._bag.add_topic(name, message_type)
        self._bag.write(self._beside[name], came if self._may_skip else stamp, message)

    @property
    def held(self) -> int:
        """Stamp up to which the run is held, in nanoseconds; negative before the first step is complete."""
        return (min(map(len, self._pacing)) - 1) * self._period

    @property
    def silent(self) -> list[str]:
        """The topics on which nothing has been heard yet; real time begins when there is none."""
        return [topic.name for topic, messages in zip(self._topics, self._messages, strict=True) if not messages]

    def checkpoint(self) -> None:
        """Bring what was written so far to the disk, for times when no message comes."""
        if self._bag is not None:
            self._bag.checkpoint_where_due()

    def recording(self) -> Recording:
        """All complete steps as arrays; a topic that said nothing at all is left out."""
        steps = self.held // self._period + 1
        frames = frame.stack(steps, self._period)
        spoke = [topic for topic, messages in zip(self._topics, self._messages, strict=True) if messages]
        for topic, messages in zip(self._topics, self._messages, strict=True):
            if messages:
                MessageTable(topic).read(messages[:steps] + messages[-1:] * (steps - len(messages)), frames)
        return recording_of(frames, spoke)

    def close(self) -> None:
        """Finish the bag."""
        if self._bag is not None:
            self._bag.close()


def write_bag(recording: Recording, topics: Sequence[Topic], names: Sequence[str], period: int, bag: Path) -> None:
    """The bag of a run that had no messages: the same bytes that the nodes would have sent.

    KeyboardInterrupt, when the message that is being written is there as a whole, if Ctrl-C or SIGTERM came.
    """
    frames = frame.stack(len(recording.time), period)
    for topic in topics:
        frames[:, frame.PLACES[topic.signal]] = np.stack([recording.channels[name] for name in topic.channels], axis=1)
    stamp = np.arange(len(frames)) * period
    with StopRequest(patient=True) as stop, DurableBag(bag, checkpoint_period=float("inf")) as written:
        handles, messages = [], []
        for topic, name in zip(topics, names, strict=True):
            handles.append(written.add_topic(name, topic.message_type, depth=QUEUE_DEPTH))
            messages.append(MessageTable(topic).serialize(stamp, frames))
        for step in range(len(frames)):
            if stop.received:
                break
            for handle, column in zip(handles, messages, strict=True):
                written.write(handle, step * period, column[step])
    if stop.received:
        raise KeyboardInterrupt
