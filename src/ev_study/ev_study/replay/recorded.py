"""The recorded signals of a run, to be replayed, with the parameters beside them.

They are found in a bag (rosbag2, of ours or of any other recorder) or in signals.npz.

How it works: the messages of a bag are sorted by topic; their stamps, divided by the control
period, give the row of a stack of frames into which their numbers go. The record begins when all
topics have begun and ends when the first one ends. An instant without a message holds the numbers
of the one before and is marked, so that nothing is compared there.
"""

from __future__ import annotations

import resource
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import MEGABYTE, SIGNALS, TEXT, RecordingError, open_data
from ev_core.parameters.section import ANY_NAMESPACE
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.refusal import ParameterError, first_line
from ev_msgs_py.wire import MessageError, stamp_of
from ev_stack.recording import recording
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import Recording, load, recording_of, refuse_unfinished
from ev_stack.recording.spool import MessageTable
from ev_stack.scenarios.about import NAMESPACE
from ev_stack.scenarios.parameter_file import ParameterFile

_METADATA = "metadata.yaml"


@dataclass(frozen=True)
class Recorded:
    """Signals of a run at its instants, from time zero.

    A missing message holds the one before. `period` in nanoseconds. By topic, `came` (n,) marks the
    instants with a message; `arrivals` (n,) is when it was recorded [ns], -1 if it was not; it is
    empty of a run in lockstep, since its bag knows stamps alone. `parameters` are those of the
    nodes of `namespace`, if they are known. `notes`: what has been left out.
    """

    source: Path
    namespace: str
    period: int
    recording: Recording
    came: Mapping[Topic, np.ndarray]
    arrivals: Mapping[Topic, np.ndarray] = field(default_factory=dict)
    parameters: ParameterFile | None = None
    notes: tuple[str, ...] = ()

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Those that were recorded, in the order of the topic table."""
        return tuple(self.came)

    def has(self, signal: type) -> bool:
        """Return True if a signal was recorded."""
        return TOPICS[signal] in self.came

    @property
    def duration(self) -> float:
        """Time of the last instant [s]."""
        return stamps.to_seconds((len(self.recording.time) - 1) * self.period)


def refuse_short(source: Path, instants: int) -> None:
    """ParameterError unless there are two instants at least: without a step nothing is answered."""
    if instants < 2:
        raise ParameterError(
            f"{source} holds {instants} whole instants of a run, expected two or more"
        )


@dataclass(frozen=True)
class _Messages:
    """Those of one topic in the order in which they were recorded: bytes, stamps and times of arrival [ns]."""

    data: Sequence[bytes]
    stamps: np.ndarray
    came: np.ndarray


def read_bag(bag: Path, namespace: str, given: ParameterFile | None) -> Recorded:
    """The run in a bag.

    Raises ParameterError, in one line, if there is none, or RunFailed if nothing here can read
    bags.
    """
    if None in (find_spec("rosbags"), find_spec("sensor_msgs")):
        raise RunFailed(
            "a bag needs rosbags and the messages of ROS 2, which are not installed here: give"
            " signals.npz"
        )
    namespace, found = _messages(bag, namespace)
    period = _period(bag, namespace, found, given)
    # Common to all topics: before it a reader would have nothing of some role.
    first = max(int(messages.stamps.min()) for messages in found.values())
    for topic, messages in found.items():
        _refuse_time(bag, topic, messages.stamps, first, period)
    last = min(int(messages.stamps.max()) for messages in found.values())
    instants = (last - first) // period + 1
    refuse_short(bag, instants)
    frames, there, arrivals = frame.stack(instants, period), {}, {}
    for topic, messages in found.items():
        there[topic], arrivals[topic] = _put(bag, topic, messages, first, period, frames)
    # A recorder of a run in lockstep writes the stamp as the time of arrival, too: no latency is in
    # it.
    by_stamp = all(np.array_equal(messages.stamps, messages.came) for messages in found.values())
    notes = _notes(found, first, last, there)
    recording = recording_of(frames, there)
    return Recorded(
        bag, namespace, period, recording, there, {} if by_stamp else arrivals, given, notes
    )


def _messages(bag: Path, wanted: str) -> tuple[str, Mapping[Topic, _Messages]]:
    """The namespace of the contract's topics and their messages."""
    from rosbags.rosbag2 import Reader

    data: dict[tuple[str, Topic], list[bytes]] = defaultdict(list)
    came: dict[tuple[str, Topic], list[int]] = defaultdict(list)
    size = 0
    try:
        _refuse_what_blocks(bag)
        with _room_at_most(2 * SIGNALS), Reader(bag) as reader:
            known = {(c.topic, c.msgtype): _meant(c.topic, c.msgtype) for c in reader.connections}
            ours = [c for c in reader.connections if known[c.topic, c.msgtype]]
            for connection, time, message in reader.messages(ours):
                # Never None here: `ours` has the topics of the contract alone.
                place = known[connection.topic, connection.msgtype]
                if place is not None:
                    data[place].append(bytes(message))
                    came[place].append(time)
                    size += len(message)
                    # A packed bag within the limit may still unfold to more.
                    if size > SIGNALS:
                        raise ValueError(f"its messages are larger than {SIGNALS // MEGABYTE} MB")
    except MemoryError:
        largest = f"{2 * SIGNALS // MEGABYTE} MB"
        raise ParameterError(
            f"{bag}: the bag cannot be read: unfolded it takes more than {largest}"
        ) from None
    # whatever the library and its decompressors raise for what is no bag
    except Exception as error:
        raise ParameterError(f"{bag}: the bag cannot be read: {first_line(error)}") from None
    namespaces = sorted({namespace for namespace, _ in data})
    # Without a wish the only one there is; several are a question for the user.
    if wanted not in namespaces and (wanted or len(namespaces) != 1):
        have = f"those of {', '.join(namespaces)}" if namespaces else "none"
        raise ParameterError(
            f"{bag}: topics of one graph are wanted (--namespace), the bag has {have}"
        )
    namespace = wanted or namespaces[0]
    order = [TOPICS[signal] for signal in RECORDED if (namespace, TOPICS[signal]) in data]
    try:
        return namespace, {
            topic: _Messages(
                data[namespace, topic],
                np.array([stamp_of(message) for message in data[namespace, topic]]),
                np.array(came[namespace, topic]),
            )
            for topic in order
        }
    except MessageError as error:
        raise ParameterError(f"{bag}: {error}") from None


@contextmanager
def _room_at_most(more: int) -> Iterator[None]:
    """MemoryError where a block takes so many bytes more, OSError where a file of it becomes larger than they.

    A compressed chunk unfolds to any size, whatever its header, and a compressed file does on the
    disk. Only Linux keeps the limit of memory.
    """
    limits = {resource.RLIMIT_FSIZE: more}
    if sys.platform == "linux":
        # Data and stack of this process by now, in pages: the limit counts them as well.
        taken = int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
        limits[resource.RLIMIT_DATA] = taken + more
    before = {kind: resource.getrlimit(kind) for kind in limits}
    try:
        for kind, most in limits.items():
            soft, hard = before[kind]
            resource.setrlimit(
                # A user's own limit stays if it is lower.
                kind,
                (most if soft == resource.RLIM_INFINITY else min(soft, most), hard),
            )
        yield
    finally:
        for kind, limit in before.items():
            resource.setrlimit(kind, limit)


def _refuse_what_blocks(bag: Path) -> None:
    """OSError unless all files of a bag are regular ones of a bounded size."""
    if bag.is_dir():
        open_data(bag / "metadata.yaml", TEXT).close()
    for path in (path for path in bag.iterdir() if not path.is_dir()) if bag.is_dir() else [bag]:
        open_data(path, SIGNALS).close()


def _meant(name: str, message_type: str) -> tuple[str, Topic] | None:
    """The namespace and the topic of the contract that a full name means."""
    for signal in RECORDED:
        topic = TOPICS[signal]
        if name.endswith(f"/{topic.name}") and topic.message_type == message_type:
            return name.removesuffix(f"/{topic.name}"), topic
    return None


def _period(
    bag: Path, namespace: str, found: Mapping[Topic, _Messages], given: ParameterFile | None
) -> int:
    """The control period: that of the nodes, if it is known, else what most stamps are apart."""
    values = given.values_for(f"{namespace}/plant") if given else {}
    if "control_period" in values:
        return stamps.from_seconds(values["control_period"])
    # Unique stamps: a repeated message has a step of zero.
    steps = np.concatenate([np.diff(np.unique(messages.stamps)) for messages in found.values()])
    refuse_short(bag, len(steps) + 1)
    return int(np.median(steps))


def _refuse_time(bag: Path, topic: Topic, at: np.ndarray, first: int, period: int) -> None:
    """ParameterError if stamps are between two steps or go back, as after a reset.

    A repetition may be there.
    """
    # A stamp between two steps belongs to no row.
    if len(odd := at[(at - first) % period != 0]):
        allowed = (
            f"multiples of {stamps.to_seconds(period):g} s from {stamps.to_seconds(first):g} s on"
        )
        raise ParameterError(
            f"{bag}: {topic.name} at {stamps.to_seconds(int(odd[0]))} s, expected {allowed}"
        )
    # A repeated message may be a step or two behind; more is another run.
    if len(back := np.flatnonzero(np.diff(at) < -2 * period)):
        ends = [f"{stamps.to_seconds(int(stamp)):g} s" for stamp in at[back[0] : back[0] + 2]]
        raise ParameterError(
            f"{bag}: {topic.name} goes back from {' to '.join(ends)}, expected a bag of one run"
        )


def _put(
    bag: Path, topic: Topic, messages: _Messages, first: int, period: int, frames: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Put a topic into the frames.

    The answers are the instants at which a message was there, and when it came [ns].
    """
    # a repetition is the same
    steps, once = np.unique((messages.stamps - first) // period, return_index=True)
    numbers = np.empty((len(once), frame.SIZE))
    try:
        MessageTable(topic).read([messages.data[i] for i in once], numbers)
    except MessageError as error:
        raise ParameterError(f"{bag}: {topic.name}: {error}") from None
    instants = np.arange(len(frames))
    # The row of the last message up to each instant.
    held = np.searchsorted(steps, instants, side="right") - 1
    there: np.ndarray = steps[held] == instants
    where = frame.PLACES[topic.signal]
    frames[:, where] = numbers[held, where]
    return there, np.where(there, messages.came[once][held], -1)


def _notes(
    found: Mapping[Topic, _Messages], first: int, last: int, there: Mapping[Topic, np.ndarray]
) -> tuple[str, ...]:
    """Notes on what a replay of this bag leaves out or makes up."""
    notes = []
    if first >= stamps.RUNS:  # below that it is the first instant of a run behind a reset
        notes.append(
            f"time counts from the stamp {stamps.to_seconds(first):g} s on, the first one of all"
            " topics"
        )
    ends = {topic.name: int(messages.stamps.max()) for topic, messages in found.items()}
    if max(ends.values()) > last:
        early = [name for name, end in ends.items() if end == last]
        notes.append(
            f"ends at {stamps.to_seconds(last):g} s, for that is the last of {', '.join(early)}"
        )
    for topic, came in there.items():
        if not came.all():
            notes.append(
                f"{topic.name}: {np.sum(~came)} of {len(came)} messages are missing, the one before"
                " is held"
            )
    return tuple(notes)


def find_recorded(path: Path, namespace: str = "") -> Recorded:
    """Read a folder of a run, a bag or a file of signals.

    `namespace` is that of the topics, where a bag has several. ParameterError, in one line, if
    nothing can be read.
    """
    storage, folder = _found(path)
    parameters = folder / recording.PARAMETERS
    given = ParameterFile(parameters) if parameters.exists() else None
    if storage.name.endswith(".npz"):
        return _of_signals(storage, given)
    return read_bag(storage, namespace, given)


def _found(path: Path) -> tuple[Path, Path]:
    """The bag or file of signals that a path means, and the folder of the run."""
    if path.is_dir():
        if (path / _METADATA).exists():
            return path, path.parent
        if (path / recording.BAG / _METADATA).exists():
            return path / recording.BAG, path
        if (path / recording.SIGNALS).exists():
            return path / recording.SIGNALS, path
        below = sorted(
            each.name
            for each in path.iterdir()
            if (each / recording.BAG).is_dir() or (each / recording.SIGNALS).exists()
        )
        if below:
            raise ParameterError(
                f"{path} has several runs, expected one: {', '.join(str(path / b) for b in below)}"
            )
    elif path.suffix in (".mcap", ".db3"):
        refuse_unfinished(path)
        bag = path.parent / _METADATA
        # A bag of ours is a folder in that of its run, beside parameters.yaml.
        return path, path.parent.parent if bag.exists() else path.parent
    elif path.suffix == ".npz":
        return path, path.parent
    if not path.exists():
        raise ParameterError(f"{path}: no such bag")
    # A bag without an index would look like no run at all.
    refuse_unfinished(path)
    refuse_unfinished(path / recording.BAG)
    raise ParameterError(
        f"{path} is no recorded run: neither a bag (metadata.yaml, .mcap, .db3) nor signals.npz"
    )


def _of_signals(file: Path, given: ParameterFile | None) -> Recorded:
    try:
        recording = load(file)
    except RecordingError as error:
        raise ParameterError(str(error)) from None
    except OSError as error:
        raise ParameterError(f"{file}: {error.strerror}") from None
    steps = np.rint(recording.time * stamps.NANOSECONDS).astype(np.int64)
    refuse_short(file, len(steps))
    period = int(steps[1])
    if period <= 0 or not np.array_equal(steps, np.arange(len(steps)) * period):
        raise ParameterError(
            f"{file}: its instants are not those of a control period from time zero on"
        )
    topics = [
        TOPICS[signal]
        for signal in RECORDED
        if set(TOPICS[signal].channels) <= set(recording.channels)
    ]
    there = np.ones(len(steps), bool)
    sections = [
        section
        for section in (given.sections if given else ())
        if not section.startswith(ANY_NAMESPACE)
    ]
    # that of the nodes with parameters
    namespace = sections[0].rpartition("/")[0] if sections else NAMESPACE
    return Recorded(
        file, namespace, period, recording, dict.fromkeys(topics, there), parameters=given
    )
