"""Keeps a whole run: every message in a bag as it came, every number in an array, and where both go.

How it works: each topic has a `SpooledTopic`, which knows how many steps it holds. A message of the
next step is appended, one of an earlier step repeats it, and a later one shows a gap: in lockstep a
loss, in real time filled by the step before. The run is held up to the step that all pacing topics
have. Numbers go to the disk in blocks of steps (`spool`), the bag is written as messages come, and
signals.npz at the end.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import TIME
from ev_core.parameters.declaration import setting
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import MASTER, RECORDED, ROLES
from ev_msgs_py.contract.topics import QUEUE_DEPTH, TOPICS, Topic
from ev_msgs_py.refusal import ParameterError, quoted
from ev_msgs_py.wire import MessageError, stamp_of
from ev_nodes.master.real_time import LONGEST
from ev_nodes.stepping.stop_request import StopRequest
from ev_stack.recording.bag_writer import BagWriter
from ev_stack.recording.recording import (
    BAG,
    SIGNALS,
    Recording,
    free_path,
    naming,
    write_signals,
)
from ev_stack.recording.shown import Shown, ViewsInBag
from ev_stack.recording.spool import BLOCK, MessageTable, Spool, SpooledTopic

_ALL_TOPICS = tuple(TOPICS[signal].name for signal in RECORDED)


@dataclass(frozen=True, slots=True)
class RecorderParameters:
    """Topics that are recorded, and the folder for them."""

    directory: str = setting(
        "recording", about="folder for bag/ and signals.npz, made if need be", read_only=True
    )
    topics: tuple[str, ...] = setting(
        _ALL_TOPICS,
        choices=_ALL_TOPICS,
        about="topics that belong to every step of this run",
        read_only=True,
    )
    bag: bool = setting(True, about="write a bag besides signals.npz", read_only=True)
    parameter_file: str = setting(
        "",
        about=(
            "parameter file that all nodes of the run were started with: the bag gets what it"
            " holds, and the car for viewers; empty: neither"
        ),
        read_only=True,
    )
    control_period: float = setting(
        0.01,
        unit="s",
        low=1e-4,
        high=1.0,
        about="step of the graph, the same for all nodes",
        read_only=True,
    )
    mode: str = setting(
        "lockstep",
        choices=("lockstep", "realtime"),
        about=(
            "lockstep: every topic has every step; realtime: a step that is missing holds the one"
            " before"
        ),
        read_only=True,
    )
    duration: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=LONGEST,
        about="the node ends when it holds this time; 0: never",
        read_only=True,
    )


class RunRecorder:
    """Collects the serialized messages of the recorded topics, one per topic and step, in memory that does not grow.

    `names` are the full topic names by which the bag knows the topics. Its folder is made, and
    ParameterError if there is a recording already; a file without a name has the numbers there
    meanwhile. In real time a step that never comes holds the one before, and the run is as far as
    its master; in lockstep it is as far as its slowest topic, and a missing step is a loss. Nothing
    behind the end is kept: an integrating node is one step ahead of it. Nor is what comes after
    `close`: other nodes of the process may end later.

    When the master begins the next run (reset), or is another one that counts from zero, the arrays
    and the bag are restarted; the bag before is kept beside the new one. Messages of another run
    than the present one are not kept.
    """

    def __init__(
        self,
        p: RecorderParameters,
        topics: Sequence[Topic],
        names: Sequence[str],
        shown: Shown | None = None,
    ) -> None:
        folder = Path(p.directory)
        if any(
            os.path.lexists(folder / name) for name in ((BAG, SIGNALS) if p.bag else (SIGNALS,))
        ):
            raise ParameterError(
                f"parameter directory: {quoted(p.directory)} is refused, expected one without a"
                " recording"
            )
        folder.mkdir(parents=True, exist_ok=True)
        self._signals, self._is_written = folder / SIGNALS, False
        self._topics = tuple(topics)
        self._names = tuple(names)
        self._shown = shown
        self._period = stamps.from_seconds(p.control_period)
        self._may_skip = p.mode == "realtime"
        last = stamps.from_seconds(p.duration) // self._period
        # Both ends are steps; a duration of 0 means without an end.
        self._steps = last + 1 if last else float("inf")
        self._spool = Spool(folder)
        self._tables = [MessageTable(topic) for topic in topics]
        self._messages = [SpooledTopic(topic, self._spool) for topic in topics]
        self._masters = {
            i for i, topic in enumerate(topics) if topic.signal in ROLES[MASTER].writes
        }
        # In real time nothing waits: a topic that lacks steps must not hold the recording up.
        self._pacing = (
            [self._messages[i] for i in self._masters] if self._may_skip else self._messages
        )
        self._directory = folder / BAG if p.bag else None
        self._run = 0  # what stamps are above the instants that they mean [ns]
        # the same of the run before a reset, while messages of it may still come
        self._before: int | None = None
        self._begin_bag()
        self.loss = ""
        self.asked = False  # whether the master has repeated itself: it may wait for the recorder

    def _begin_bag(self) -> None:
        self._bag = BagWriter(self._directory) if self._directory is not None else None
        self._handles = [
            (
                self._bag.add_topic(name, topic.message_type, depth=QUEUE_DEPTH)
                if self._bag is not None
                else None
            )
            for topic, name in zip(self._topics, self._names, strict=True)
        ]
        self._beside: dict[str, object] = {}
        self._views = (
            ViewsInBag(self._bag, self._shown, self._topics, self._period)
            if self._bag and self._shown
            else None
        )

    def add(
        self,
        index: int,
        messages: Sequence[bytes],
        came: Sequence[int],
        refuse: Callable[[MessageError], None],
    ) -> None:
        """Keep messages of the topic with this index.

        One that repeats an earlier stamp adds nothing.

        In real time the bag has them under the wall times at which they came [ns], in lockstep
        under their stamps. `refuse` is given the reason of each that the topic table does not
        allow.
        """
        if self._is_written:
            return
        refused: set[int] = set()

        def note(place: int, error: MessageError) -> None:
            refused.add(place)
            refuse(error)

        numbers = self._tables[index].numbers(messages, note)
        for place, message in enumerate(messages):
            if place not in refused:
                self._add(index, message, numbers[place], came[place])

    def _add(self, index: int, message: bytes, numbers: np.ndarray, came: int) -> None:
        kept = self._messages[index]
        # The rest of a stamp above a multiple of the period is the number of its run.
        step, run = divmod(stamp_of(message), self._period)
        # Only the master begins a run: a first step of another node may still be of the run before.
        if step == 0 and index in self._masters and self._begins_run(run, kept, message):
            self._begin_anew(run)
        if run != self._run:
            return
        if (
            step >= self._steps
            or step < kept.count
            or (run == self._before and index not in self._masters)
        ):
            # A master that repeats a step waits for a node, perhaps for our progress.
            self.asked = self.asked or index in self._masters
            return
        if self._may_skip and index not in self._masters and step > self._paced() + 1:
            return  # no node is ahead of the master by more than one step: a stranger's stamp
        if step > kept.count:
            if self._may_skip:
                # The numbers of a step that never came are those of the step before.
                for _ in range(kept.count, step):
                    kept.hold(message, numbers)
            else:
                # before its first a topic is not connected yet; the master repeats the first step
                if kept.count:
                    self._note_loss(index, kept.count, step)
                return
        kept.append(message, numbers)
        if self._bag is not None:
            # In lockstep the time of arrival has no meaning for the car, and differs from run to
            # run.
            at = came if self._may_skip else step * self._period
            self._bag.write(self._handles[index], at, message)
            if self._views is not None:
                self._views.take(step, frame.PLACES[self._topics[index].signal], numbers, at)

    def _begins_run(self, run: int, kept: SpooledTopic, message: bytes) -> bool:
        """Return True if the first state is that of a later run, or of another master."""
        # A first step again is a repetition, unless steps followed it or it has another content.
        if run == self._run:
            return kept.count > 1 or (kept.count == 1 and message != kept.first)
        return self._run < run < stamps.RUNS or (run == 0 and self._before is None)

    def _begin_anew(self, run: int) -> None:
        before, self._run = self._run, run
        if not any(kept.count for kept in self._messages):  # it has joined behind resets
            return
        if self._bag is not None:
            self._close_bag()
            # The bag of the run before stays beside; its arrays do not.
            self._directory.rename(free_path(Path(f"{self._directory}_before_reset_")))
        for kept in self._messages:
            kept.clear()
        self._spool.clear()
        self.loss = ""
        self._before = before
        if self._bag is not None:
            self._begin_bag()

    def took_all(self) -> None:
        """Forget the run before a reset.

        Call this when every message that had arrived was added.
        """
        self._before = None
        if self._views is not None:  # in real time what is of the newest instant may still come
            self._views.write(self._paced() - self._may_skip)

    def _note_loss(self, index: int, due: int, came: int) -> None:
        first, last = (stamps.to_seconds(step * self._period) for step in (due, came))
        self.loss = f"{self._topics[index].name} at {first} s did not come, but {last} s did"

    def add_beside(
        self, name: str, message_type: str, stamp: int, message: bytes, came: int
    ) -> bool:
        """Put a message that is no signal of the contract, such as /clock, into the bag only.

        False if it is too early.

        It is for a run that has yet to begin. One of a run before is not kept.
        """
        if self._bag is None or self._is_written or stamp % self._period < self._run:
            return True
        if stamp % self._period > self._run:
            return False
        if name not in self._beside:
            self._beside[name] = self._bag.add_topic(name, message_type)
        self._bag.write(
            self._beside[name], came if self._may_skip else max(stamp - self._run, 0), message
        )
        return True

    @property
    def held(self) -> int:
        """The instant up to which the run is held, in nanoseconds.

        Negative before the first step is complete.
        """
        return (self._paced() - 1) * self._period

    @property
    def held_stamp(self) -> int:
        """The stamp of that instant."""
        return self.held + self._run

    def _paced(self) -> int:
        """So many steps are complete."""
        return min(kept.count for kept in self._pacing)

    @property
    def silent(self) -> list[str]:
        """The topics on which nothing has come yet; real time begins when there is none."""
        return [
            topic.name
            for topic, kept in zip(self._topics, self._messages, strict=True)
            if not kept.count
        ]

    def flush(self) -> None:
        """Bring what was written so far to the disk, for times when no message comes."""
        if self._bag is not None:
            self._bag.flush_where_due()

    @property
    def is_complete(self) -> bool:
        """True once everything up to the end of the run is held."""
        return self._paced() >= self._steps

    def close(self) -> None:
        """Finish the bag, and write signals.npz with all complete steps, once.

        A topic without messages is left out.
        """
        if self._is_written:
            return
        self._is_written = True
        with closing(self._spool):
            try:
                if self._bag is not None:
                    self._close_bag()
            finally:  # what the bag has no room for may still fit in there
                write_signals(self._signals, self._series())

    def _close_bag(self) -> None:
        try:
            if self._views is not None:
                self._views.write(self._paced(), few=False)
        finally:
            self._bag.close()

    def _series(self) -> Iterator[tuple[str, np.ndarray]]:
        steps = self._paced()
        yield TIME, frame.times(steps, self._period)
        for topic, kept in zip(self._topics, self._messages, strict=True):
            if kept.count:
                yield from zip(topic.channels, kept.series(steps), strict=True)


def write_bag(
    recording: Recording,
    topics: Sequence[Topic],
    names: Sequence[str],
    period: int,
    bag: Path,
    shown: Shown | None = None,
) -> None:
    """The bag of a run that had no messages: the same bytes that the nodes would have sent.

    KeyboardInterrupt, when the message that is being written is there as a whole, if Ctrl-C or
    SIGTERM came. OSError names the bag.
    """
    with (
        naming(bag),
        StopRequest(patient=True) as stop,
        BagWriter(bag, flush_period=float("inf")) as written,
    ):
        handles = [
            written.add_topic(name, topic.message_type, depth=QUEUE_DEPTH)
            for topic, name in zip(topics, names, strict=True)
        ]
        for step, messages in enumerate(_messages_of(recording, topics, period)):
            if stop.received:
                break
            for handle, message in zip(handles, messages, strict=True):
                written.write(handle, step * period, message)
        if shown is not None and not stop.received:
            ViewsInBag(written, shown, topics, period).write_all(recording)
    if stop.received:
        raise KeyboardInterrupt


def _messages_of(
    recording: Recording, topics: Sequence[Topic], period: int
) -> Iterator[tuple[bytes, ...]]:
    """Those of each step, made in blocks."""
    tables = [MessageTable(topic) for topic in topics]
    for begin in range(0, len(recording.time), BLOCK):
        stamp = np.arange(begin, min(begin + BLOCK, len(recording.time))) * period
        frames = np.empty((len(stamp), frame.SIZE))
        for topic in topics:
            channels = [recording.channels[name][begin : begin + BLOCK] for name in topic.channels]
            frames[:, frame.PLACES[topic.signal]] = np.stack(channels, axis=1)
        yield from zip(*(table.serialize(stamp, frames) for table in tables), strict=True)
