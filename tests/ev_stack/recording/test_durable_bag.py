"""The bag on disk is complete at every instant.

After an end in good order, a kill at any moment, a full disk.
"""

from __future__ import annotations

import errno
import mmap
import os
import random
import resource
import signal
import struct
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import pytest
from helpers.patience import wait_until
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection, QosDurability, QosHistory, QosReliability
from rosbags.rosbag2 import Reader, ReaderError

from ev_stack.recording.durable_bag import DurableBag, TwinStorage

pytestmark = pytest.mark.slow

NEVER = 1e9  # seconds between checkpoints, for tests that ask for each checkpoint themselves
INT64 = "std_msgs/msg/Int64"


def int64_message(value: int) -> bytes:
    """CDR of std_msgs/Int64, little endian with encapsulation header."""
    return b"\x00\x01\x00\x00" + struct.pack("<q", value)


def add_two_topics(bag: DurableBag) -> list[Connection]:
    return [bag.add_topic(name, INT64) for name in ("/even", "/odd")]


def write_counters(bag: DurableBag, topics: list[Connection], counters: range) -> None:
    """Write the counters to the two topics in turn, stamped with a microsecond each."""
    for counter in counters:
        bag.write(topics[counter % 2], counter * 1000, int64_message(counter))


def read_counters(directory: Path) -> list[int]:
    """Read the counters by a standard reader, and check that metadata.yaml counts just those."""
    with AnyReader([directory]) as reader:
        counters = [
            reader.deserialize(data, topic.msgtype).data for topic, _, data in reader.messages()
        ]
        assert reader.message_count == len(counters)
        assert sum(topic.msgcount for topic in reader.connections) == len(counters)
    return counters


def on_disk(directory: Path) -> bool:
    """Return True once a checkpoint has brought messages to the disk."""
    try:
        with Reader(directory) as reader:
            return reader.message_count > 0
    except (OSError, ReaderError):  # not there yet, or just being exchanged
        return False


def assert_every_file_opens(directory: Path) -> None:
    """Check that each file opened by hand, past metadata.yaml, is complete as well."""
    for path in directory.glob("*.mcap"):
        with Reader(path) as reader:
            assert sum(1 for _ in reader.messages()) == reader.message_count


def in_child(work: Callable[[], None]) -> int:
    """Do the work in a forked process and give its id; it never outlives a failed test for long."""
    child = os.fork()
    if child:
        return child
    try:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(10)
        work()
    finally:
        os._exit(1)  # never back into pytest; a killed child does not get here


def assert_killed(child: int) -> None:
    """The child was still at work when the signal came: it did not end by itself."""
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL


def test_messages_come_back_bit_for_bit(tmp_path: Path):
    """Several chunks (1 MiB each) and several checkpoints.

    Data of every kind, also what would not compress.
    """
    noise = random.Random(1)
    messages = [(stamp, noise.randbytes(noise.randrange(4, 2000))) for stamp in range(3000)]
    with DurableBag(tmp_path / "bag", checkpoint_period=NEVER) as bag:
        topics = add_two_topics(bag)
        for stamp, data in messages:
            bag.write(topics[stamp % 2], stamp, data)
            if stamp % 1000 == 0:
                bag.checkpoint()
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [(stamp, data) for _, stamp, data in reader.messages()] == messages
        assert {topic.topic: topic.msgcount for topic in reader.connections} == {
            "/even": 1500,
            "/odd": 1500,
        }
    assert sorted(path.name for path in (tmp_path / "bag").iterdir()) == [
        "bag.mcap",
        "metadata.yaml",
    ]


def test_topic_added_late_is_recorded(tmp_path: Path):
    with DurableBag(tmp_path / "bag") as bag:
        bag.write(bag.add_topic("/early", INT64), 1, int64_message(0))
        bag.checkpoint()
        bag.write(bag.add_topic("/late", "sensor_msgs/msg/JointState"), 2, bytes(64))
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [topic.topic for topic, _, _ in reader.messages()] == ["/early", "/late"]


def test_quality_of_service_is_that_of_the_publisher(tmp_path: Path):
    """`ros2 bag play` offers what is written here."""
    with DurableBag(tmp_path / "bag") as bag:
        bag.add_topic("/command", INT64, depth=3)
    with Reader(tmp_path / "bag") as reader:
        offered = {topic.topic: topic.ext.offered_qos_profiles[0] for topic in reader.connections}
    assert {
        name: (quality.depth, quality.reliability, quality.durability)
        for name, quality in offered.items()
    } == {
        "/command": (3, QosReliability.RELIABLE, QosDurability.VOLATILE),
    }
    assert all(quality.history is QosHistory.KEEP_LAST for quality in offered.values())


@pytest.mark.parametrize("topics", [(), ("/silent",)])
def test_bag_without_messages_reads(tmp_path: Path, topics: tuple[str, ...]):
    with DurableBag(tmp_path / "bag") as bag:
        for name in topics:
            bag.add_topic(name, INT64)
    with Reader(tmp_path / "bag") as reader:
        assert [topic.topic for topic in reader.connections] == list(topics)
        assert list(reader.messages()) == []


def test_existing_directory_is_refused_untouched(tmp_path: Path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError) as refusal:
        DurableBag(tmp_path)
    assert str(refusal.value) == f"{tmp_path} exists already: a recording needs a new directory"
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_write_makes_a_checkpoint_when_the_period_is_over(tmp_path: Path):
    now = 0.0
    with DurableBag(tmp_path / "bag", checkpoint_period=0.5, clock=lambda: now) as bag:
        topics = add_two_topics(bag)
        write_counters(bag, topics, range(10))
        assert len(read_counters(tmp_path / "bag")) == 0
        now = 0.5
        write_counters(bag, topics, range(10, 12))
        assert read_counters(tmp_path / "bag") == list(range(11))
        write_counters(bag, topics, range(12, 20))
        assert read_counters(tmp_path / "bag") == list(range(11))
        now = 1.0
        write_counters(bag, topics, range(20, 21))
        assert read_counters(tmp_path / "bag") == list(range(21))


def test_kill_at_random_moments_keeps_every_checkpoint(tmp_path: Path):
    """Ten children write and save as fast as they can, so that most kills fall into a checkpoint."""
    delays = random.Random(2)
    for run in range(10):
        directory = tmp_path / f"run{run}"
        shared = mmap.mmap(
            -1, 16
        )  # counters written and counters saved, as the child last reported

        def record(directory: Path = directory, shared: mmap.mmap = shared) -> None:
            bag = DurableBag(directory, checkpoint_period=NEVER)
            topics = add_two_topics(bag)
            written = 0
            while True:
                write_counters(bag, topics, range(written, written + 500))
                written += 500
                struct.pack_into("<q", shared, 0, written)
                bag.checkpoint()
                struct.pack_into("<q", shared, 8, written)

        child = in_child(record)
        wait_until(lambda shared=shared: struct.unpack_from("<q", shared, 8)[0] >= 1000)
        time.sleep(delays.uniform(0.0, 0.3))
        os.kill(child, signal.SIGKILL)
        assert_killed(child)

        written, saved = struct.unpack("<qq", shared[:])
        counters = read_counters(directory)
        assert counters == list(range(len(counters)))
        assert saved <= len(counters) <= written
        assert_every_file_opens(directory)


def test_kill_loses_less_than_a_second(tmp_path: Path):
    """The last message on disk is less than a second older than the kill, by default."""

    def record(directory: Path) -> None:
        bag = DurableBag(directory)
        topics = add_two_topics(bag)
        counter = 0
        while True:
            bag.write(topics[counter % 2], time.time_ns(), int64_message(counter))
            counter += 1
            time.sleep(0.0005)

    directories = [tmp_path / f"run{run}" for run in range(4)]
    children = [
        in_child(lambda directory=directory: record(directory)) for directory in directories
    ]
    wait_until(lambda: all(on_disk(directory) for directory in directories))
    for directory, child, delay in zip(directories, children, (0.1, 0.2, 0.1, 0.2), strict=True):
        time.sleep(delay)
        killed = time.time_ns()
        os.kill(child, signal.SIGKILL)
        assert_killed(child)
        counters = read_counters(directory)
        assert counters == list(range(len(counters)))
        with Reader(directory) as reader:
            assert 0 <= killed - reader.end_time < 1_000_000_000


def test_kill_before_any_step_on_the_file_system(tmp_path: Path):
    """A child kills itself before its first, second, ...

    Opening, renaming or removing of a file, until none is left.

    Chance would mostly miss the instants between two renames; this does not.
    """

    def record(directory: Path, steps: int, saved: mmap.mmap) -> None:
        def die_in_time(event: str, arguments: tuple) -> None:
            nonlocal steps
            if event in {"open", "os.rename", "os.remove"} and str(directory) in str(arguments[0]):
                if steps == 0:
                    os.kill(os.getpid(), signal.SIGKILL)
                steps -= 1

        bag = DurableBag(directory, checkpoint_period=NEVER)
        topics = add_two_topics(bag)
        sys.addaudithook(die_in_time)
        for start in (0, 100, 200):
            write_counters(bag, topics, range(start, start + 100))
            bag.checkpoint()
            saved[0] = start // 100 + 1
        write_counters(bag, topics, range(300, 400))
        bag.close()
        os._exit(0)

    steps = 0
    while True:
        directory = tmp_path / f"step{steps}"
        saved = mmap.mmap(-1, 1)
        child = in_child(
            lambda directory=directory, steps=steps, saved=saved: record(directory, steps, saved)
        )
        ending = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        counters = read_counters(directory)
        assert counters in (list(range(100 * saved[0])), list(range(100 * saved[0] + 100)))
        assert_every_file_opens(directory)
        if ending == 0:
            break
        assert ending == -signal.SIGKILL
        steps += 1
    assert steps >= 20  # four commits of five steps each, and the end
    assert len(counters) == 400


def test_full_disk_leaves_the_last_checkpoint_and_is_made_good_later(tmp_path: Path):
    """A limit on the size of files tears the write in the middle, as a full disk would."""
    noise = random.Random(3)
    messages = [(stamp, noise.randbytes(1000)) for stamp in range(600)]

    def read() -> list[tuple[int, bytes]]:
        with AnyReader([tmp_path / "bag"]) as reader:
            return [(stamp, data) for _, stamp, data in reader.messages()]

    with DurableBag(tmp_path / "bag", checkpoint_period=NEVER) as bag:
        topic = bag.add_topic("/noise", INT64)
        for stamp, data in messages[:200]:
            bag.write(topic, stamp, data)
        bag.checkpoint()
        for stamp, data in messages[200:400]:
            bag.write(topic, stamp, data)
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, hard))
        try:
            for _ in range(2):
                with pytest.raises(OSError, match="File too large"):
                    bag.checkpoint()
                assert read() == messages[:200]
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        bag.checkpoint()
        assert read() == messages[:400]
        for stamp, data in messages[400:]:
            bag.write(topic, stamp, data)
    assert read() == messages


@pytest.mark.parametrize("room", [0, 30, 200, 1000, 5000, 50_000])
def test_a_bag_is_readable_or_not_there_however_little_room_there_is(room: int, tmp_path: Path):
    """Less than what an empty bag takes had left a folder without metadata."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, hard))
    try:
        with DurableBag(tmp_path / "bag", NEVER) as bag:
            topics = add_two_topics(bag)
            write_counters(bag, topics, range(100))
            bag.checkpoint()
    except OSError:
        assert room < 50_000
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    if (tmp_path / "bag").exists():
        assert read_counters(tmp_path / "bag") in ([], list(range(100)))


def test_failed_exchange_of_metadata_is_made_good_later(tmp_path: Path):
    """The new file has its name already when metadata.yaml cannot be written.

    The old one must stay the valid one.
    """
    with DurableBag(tmp_path / "bag", checkpoint_period=NEVER) as bag:
        topics = add_two_topics(bag)
        write_counters(bag, topics, range(10))
        bag.checkpoint()
        write_counters(bag, topics, range(10, 20))
        obstacle = tmp_path / "bag" / "metadata.yaml.tmp"
        obstacle.mkdir()
        for _ in range(2):
            with pytest.raises(IsADirectoryError):
                bag.checkpoint()
            assert read_counters(tmp_path / "bag") == list(range(10))
        obstacle.rmdir()
        write_counters(bag, topics, range(20, 30))
        bag.checkpoint()
        assert read_counters(tmp_path / "bag") == list(range(30))
    assert read_counters(tmp_path / "bag") == list(range(30))


def test_a_bag_that_cannot_begin_leaves_nothing_that_is_written_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The library asks for its version when the file is open.

    Without a descriptor the file outlived the error.
    """

    def no_descriptor(_name: str) -> str:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr("rosbags.rosbag2.storage_mcap.version", no_descriptor)
    kept = []
    with pytest.raises(OSError, match="Too many open files") as error:
        DurableBag(tmp_path / "bag")
    for frame, _ in traceback.walk_tb(error.tb):
        kept += [each for each in frame.f_locals.values() if isinstance(each, TwinStorage)]
    assert not (tmp_path / "bag").exists()
    assert kept and all(each.bio.closed for each in kept)
