"""A bag is readable after a good end, and to the last second after a kill or on a full disk."""

from __future__ import annotations

import errno
import mmap
import os
import random
import resource
import signal
import struct
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from helpers.patience import wait_until
from helpers.scanned_bag import scanned
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection, QosDurability, QosHistory, QosReliability
from rosbags.rosbag2 import Reader

from ev_stack.recording.bag_writer import BagWriter

pytestmark = pytest.mark.slow

NEVER = 1e9  # s between flushes
INT64 = "std_msgs/msg/Int64"


def int64_message(value: int) -> bytes:
    """CDR of std_msgs/Int64, little endian with encapsulation header."""
    return b"\x00\x01\x00\x00" + struct.pack("<q", value)


def add_two_topics(bag: BagWriter) -> list[Connection]:
    return [bag.add_topic(name, INT64) for name in ("/even", "/odd")]


def write_counters(bag: BagWriter, topics: list[Connection], counters: range) -> None:
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


def scanned_counters(directory: Path) -> list[int]:
    """Counters on the disk, whether the bag was closed or not."""
    messages = scanned(directory / f"{directory.name}.mcap")
    return [struct.unpack("<q", data[4:])[0] for _, data in messages]


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
    """Several chunks (1 MiB each) and flushes, data of every kind, also incompressible ones."""
    noise = random.Random(1)
    messages = [(stamp, noise.randbytes(noise.randrange(4, 2000))) for stamp in range(3000)]
    now = 0.0
    with BagWriter(tmp_path / "bag", flush_period=500.0, clock=lambda: now) as bag:
        topics = add_two_topics(bag)
        for stamp, data in messages:
            now = stamp
            bag.write(topics[stamp % 2], stamp, data)
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


@settings(max_examples=20, deadline=None)
@given(
    sizes=st.lists(st.integers(0, 3000), max_size=40),
    period=st.sampled_from([0.0, 0.5, 5.0, NEVER]),
    data=st.data(),
)
def test_a_file_that_is_cut_off_anywhere_holds_whole_messages_in_order(
    tmp_path_factory, sizes, period, data
):
    """A kill may come at any byte: what is scanned is a beginning of what was written."""
    directory = tmp_path_factory.mktemp("cut") / "bag"
    now = 0.0
    messages = [(n, int64_message(n) + bytes(size)) for n, size in enumerate(sizes)]
    with BagWriter(directory, flush_period=period, clock=lambda: now) as bag:
        topics = add_two_topics(bag)
        for n, message in messages:
            now = float(n)
            bag.write(topics[n % 2], n, message)
    file = directory / "bag.mcap"
    assert list(scanned(file)) == messages
    whole = file.read_bytes()
    file.write_bytes(whole[: data.draw(st.integers(8, len(whole)))])
    found = list(scanned(file))
    assert found == messages[: len(found)]


def test_topic_added_late_is_recorded(tmp_path: Path):
    with BagWriter(tmp_path / "bag") as bag:
        bag.write(bag.add_topic("/early", INT64), 1, int64_message(0))
        bag.write(bag.add_topic("/late", "sensor_msgs/msg/JointState"), 2, bytes(64))
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [topic.topic for topic, _, _ in reader.messages()] == ["/early", "/late"]


def test_quality_of_service_is_that_of_the_publisher(tmp_path: Path):
    """`ros2 bag play` offers what is written here."""
    with BagWriter(tmp_path / "bag") as bag:
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
    with BagWriter(tmp_path / "bag") as bag:
        for name in topics:
            bag.add_topic(name, INT64)
    with Reader(tmp_path / "bag") as reader:
        assert [topic.topic for topic in reader.connections] == list(topics)
        assert list(reader.messages()) == []


def test_existing_directory_is_refused_untouched(tmp_path: Path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError) as refusal:
        BagWriter(tmp_path)
    assert str(refusal.value) == f"{tmp_path} exists already: a recording needs a new directory"
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_messages_are_on_the_disk_when_the_period_is_over(tmp_path: Path):
    now = 0.0
    directory = tmp_path / "bag"
    with BagWriter(directory, flush_period=0.5, clock=lambda: now) as bag:
        topics = add_two_topics(bag)
        write_counters(bag, topics, range(10))
        assert scanned_counters(directory) == []
        now = 0.5
        write_counters(bag, topics, range(10, 12))
        assert scanned_counters(directory) == list(range(11))
        now = 1.0
        bag.flush_where_due()
        assert scanned_counters(directory) == list(range(12))


def test_a_closed_bag_may_be_flushed_and_closed_again(tmp_path: Path):
    """A recorder looks at the time once more behind its last message."""
    now = 0.0
    with BagWriter(tmp_path / "bag", flush_period=0.5, clock=lambda: now) as bag:
        write_counters(bag, add_two_topics(bag), range(10))
        bag.close()
        now = 1.0
        bag.flush_where_due()
    assert read_counters(tmp_path / "bag") == list(range(10))


def test_a_kill_keeps_everything_that_was_flushed(tmp_path: Path):
    """Children write and flush as fast as they can, so that most kills fall into a flush."""
    delays = random.Random(2)
    for run in range(6):
        directory = tmp_path / f"run{run}"
        shared = mmap.mmap(-1, 16)  # counters written and counters flushed

        def record(directory: Path = directory, shared: mmap.mmap = shared) -> None:
            now = 0.0
            bag = BagWriter(directory, flush_period=0.5, clock=lambda: now)
            topics = add_two_topics(bag)
            written = 0
            while True:
                write_counters(bag, topics, range(written, written + 500))
                written += 500
                struct.pack_into("<q", shared, 0, written)
                now += 1.0
                bag.flush_where_due()
                struct.pack_into("<q", shared, 8, written)

        child = in_child(record)
        wait_until(lambda shared=shared: struct.unpack_from("<q", shared, 8)[0] >= 1000)
        time.sleep(delays.uniform(0.0, 0.3))
        os.kill(child, signal.SIGKILL)
        assert_killed(child)
        written, flushed = struct.unpack("<qq", shared[:])
        counters = scanned_counters(directory)
        assert counters == list(range(len(counters)))
        assert flushed <= len(counters) <= written + 500


@pytest.fixture
def largest_file():
    """Limit the size of files: a write is torn in the middle, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield lambda size: resource.setrlimit(
        resource.RLIMIT_FSIZE, (soft if size is None else size, hard)
    )
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_disk_is_an_error_and_is_made_good_where_there_is_room_again(
    tmp_path: Path, largest_file
):
    noise = random.Random(3)
    messages = [(stamp, noise.randbytes(1000)) for stamp in range(600)]
    now = 0.0
    with BagWriter(tmp_path / "bag", flush_period=0.5, clock=lambda: now) as bag:
        topic = bag.add_topic("/noise", INT64)
        for stamp, data in messages[:200]:
            bag.write(topic, stamp, data)
        now += 1.0
        bag.flush_where_due()
        for stamp, data in messages[200:400]:
            bag.write(topic, stamp, data)
        largest_file(300_000)
        for _ in range(2):
            now += 1.0
            with pytest.raises(OSError, match="File too large"):
                bag.flush_where_due()
            found = list(scanned(tmp_path / "bag" / "bag.mcap"))
            assert found == messages[:200]
        largest_file(None)
        for stamp, data in messages[400:]:
            bag.write(topic, stamp, data)
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [(stamp, data) for _, stamp, data in reader.messages()] == messages


@pytest.mark.parametrize("room", [0, 30, 200, 1000, 5000, 50_000])
def test_however_little_room_there_is_metadata_stands_beside_a_whole_bag_only(
    room: int, tmp_path: Path, largest_file
):
    largest_file(room)
    try:
        with BagWriter(tmp_path / "bag", NEVER) as bag:
            topics = add_two_topics(bag)
            write_counters(bag, topics, range(100))
    except OSError:
        assert room < 50_000
    finally:
        largest_file(None)
    if (tmp_path / "bag" / "metadata.yaml").exists():
        assert read_counters(tmp_path / "bag") == list(range(100))


def test_a_bag_that_cannot_begin_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The library asks for its version when the file is open."""

    def no_descriptor(_name: str) -> str:
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr("rosbags.rosbag2.storage_mcap.version", no_descriptor)
    with pytest.raises(OSError, match="Too many open files"):
        BagWriter(tmp_path / "bag")
    assert not (tmp_path / "bag").exists()
