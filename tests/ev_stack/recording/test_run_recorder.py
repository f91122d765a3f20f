"""Content of a recorder: as if it kept every message, in memory that does not grow."""

from __future__ import annotations

import io
import resource
import tracemalloc
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.stamps import RUN
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.wire import MessageError, format_of, stamp_of
from ev_stack.recording import spool
from ev_stack.recording.recording import Recording, load, save
from ev_stack.recording.run_recorder import RecorderParameters, RunRecorder
from ev_stack.recording.spool import MessageTable

PERIOD = 10_000_000  # ns
NAMES = ("imu", "driver/command", "torque_request")  # the first one is the master's
USED = [topic for name in NAMES for topic in TOPICS.values() if topic.name == name]


def recorder_in(folder: Path, **changed) -> RunRecorder:
    p = RecorderParameters(str(folder), control_period=PERIOD / 1e9, **{"bag": False, **changed})
    return RunRecorder(p, USED, NAMES)


def message(topic: Topic, step: int, value: float, run: int = 0) -> bytes:
    return MessageTable(topic).serialize(
        np.array([step * PERIOD + run]), np.full((1, frame.SIZE), value)
    )[0]


def fail(error: MessageError) -> None:
    raise error


class KeepsAll:
    """Reference for a recorder: a list of messages for each topic."""

    def __init__(self, may_skip: bool, last: int) -> None:
        self.may_skip, self.last, self.kept, self.loss = may_skip, last, [[] for _ in USED], False
        self.run, self.before = 0, None

    def add(self, index: int, new: bytes) -> None:
        kept, (step, run) = self.kept[index], divmod(stamp_of(new), PERIOD)
        later = run > self.run or (run < self.run and run == 0 and self.before is None)
        if index == 0 and step == 0 and (later or (run == self.run and kept and kept != [new])):
            if any(self.kept):
                self.before, self.loss = self.run, False
            self.kept, self.run = [[] for _ in USED], run
            kept = self.kept[0]
        if run != self.run:
            return
        if step > self.last or step < len(kept) or (run == self.before and index):
            return
        if self.may_skip and index and step > len(self.kept[0]) + 1:
            return
        if step > len(kept) and not self.may_skip:
            self.loss = self.loss or bool(kept)
            return
        kept += [kept[-1] if kept else new] * (step - len(kept)) + [new]

    def steps(self) -> int:
        return len(self.kept[0]) if self.may_skip else min(map(len, self.kept))

    def recording(self) -> Recording:
        steps, channels = self.steps(), {}
        for topic, kept in zip(USED, self.kept, strict=True):
            if kept:
                held = (kept + [kept[-1]] * steps)[:steps]
                numbers = np.array(
                    [format_of(topic.signal).read(each)[1] for each in held]
                ).reshape(steps, len(topic.channels))
                channels |= {name: numbers[:, i] for i, name in enumerate(topic.channels)}
        return Recording(np.arange(steps) * PERIOD / 1e9, channels)


# Of which topic, so many steps behind or ahead of the next one (none: back to step zero), a value,
# and of which run.
heard = st.tuples(
    st.sampled_from(range(len(USED))),
    st.sampled_from((0, 0, 0, 0, 0, -1, 1, 2, 7, None)),
    st.floats(0, 9),
    st.sampled_from((0, 0, 0, 0, 0, 0, -RUN, RUN)),
)


@given(st.booleans(), st.integers(1, 30), st.lists(heard | st.none(), max_size=120))
def test_what_is_held_is_what_has_come(
    tmp_path_factory: pytest.TempPathFactory, may_skip: bool, last: int, words: list
):
    """Repeated, missing and skipped steps, the end of the run, resets.

    Blocks of four steps have many borders.
    """
    folder = tmp_path_factory.mktemp("recorder")
    with patch.object(spool, "BLOCK", 4):
        recorder = recorder_in(
            folder, mode="realtime" if may_skip else "lockstep", duration=last * PERIOD / 1e9
        )
        expected = KeepsAll(may_skip, last)
        for word in words:
            if word is None:
                recorder.took_all()
                expected.before = None
                continue
            index, ahead, value, other = word
            step = 0 if ahead is None else max(0, len(expected.kept[index]) + ahead)
            sent = message(USED[index], step, value, max(expected.run + other, 0))
            recorder.add(index, [sent], [0], fail)
            expected.add(index, sent)
            assert recorder.held_stamp == recorder.held + expected.run
            assert recorder.held == (expected.steps() - 1) * PERIOD
            assert bool(recorder.loss) == expected.loss
            assert recorder.silent == [
                name for name, kept in zip(NAMES, expected.kept, strict=True) if not kept
            ]
        recorder.close()
    assert [path.name for path in folder.iterdir()] == ["signals.npz"]
    save(expected.recording(), folder / "expected.npz")
    assert (folder / "signals.npz").read_bytes() == (folder / "expected.npz").read_bytes()


@pytest.mark.parametrize(("run", "held"), [(RUN, 0), (0, -PERIOD)])
def test_answers_that_come_with_a_reset_are_kept_where_their_stamps_tell_them_from_older_ones(
    tmp_path, run, held
):
    """After a reset they do.

    Another master counts from zero again, and repeats itself until the answers come.
    """
    recorder = recorder_in(tmp_path)
    recorder.add(0, [message(USED[0], 0, 1.0)], [0], fail)
    recorder.took_all()
    for index, topic in enumerate(USED):
        recorder.add(index, [message(topic, 0, 2.0, run)], [0], fail)
    assert recorder.held == held
    recorder.close()


def test_a_closed_recorder_keeps_nothing_more(tmp_path):
    """A plant in real time in the same process may end later and report to a closed bag."""
    recorder = recorder_in(tmp_path, bag=True, mode="realtime", duration=PERIOD / 1e9)
    for step in range(2):
        recorder.add(0, [message(USED[0], step, 1.0)], [step], fail)
    assert recorder.is_complete
    recorder.close()
    kept = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    recorder.add(1, [message(USED[1], 1, 1.0)], [2], fail)
    assert recorder.add_beside(
        "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", PERIOD, b"", 2
    )
    recorder.close()
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == kept


@pytest.mark.weekly
def test_memory_does_not_grow_with_the_steps(tmp_path: Path):
    """60 000 steps are 50 MB of messages.

    What stays are a block of each topic, and one channel at the end.
    """
    steps = 60_000
    recorder = recorder_in(tmp_path)
    tracemalloc.start()
    for begin in range(0, steps, 1000):
        stamps = np.arange(begin, begin + 1000) * PERIOD
        several = [
            MessageTable(topic).serialize(stamps, np.ones((1000, frame.SIZE))) for topic in USED
        ]
        for index, messages in enumerate(several):
            recorder.add(index, messages, [0] * len(messages), fail)
    recorder.close()
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 7e6  # bytes
    assert len(load(tmp_path / "signals.npz").time) == steps


def test_the_file_has_the_bytes_of_numpy(tmp_path: Path):
    recording = Recording(np.arange(3.0), {"b": np.array([1.0, -0.0, 2.0]), "a": np.zeros(3)})
    save(recording, tmp_path / "ours.npz")
    numpys = io.BytesIO()
    np.savez(numpys, time=recording.time, **recording.channels)
    assert (tmp_path / "ours.npz").read_bytes() == numpys.getvalue()


def test_a_file_without_room_on_the_disk_is_named(tmp_path):
    """The last line of a command has the file; only a started process has a log to name."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, limits[1]))
    try:
        with pytest.raises(OSError) as raised:
            save(Recording(np.zeros(5000), {}), tmp_path / "signals.npz")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert raised.value.filename == str(tmp_path / "signals.npz")
    assert not list(tmp_path.iterdir())
