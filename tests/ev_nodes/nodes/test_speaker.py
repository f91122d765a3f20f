"""One node may write each topic; the graph names it, by a clock that the test turns."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from ev_core.lockstep.finding import find_method
from ev_core.lockstep.stepper import Stepper
from ev_msgs_py.contract.topics import QUEUE_DEPTH
from ev_nodes.stepping import signal_io as speaker_module
from ev_nodes.stepping.reception import Reception
from ev_nodes.stepping.signal_io import Reader, Speaker

OURS, ANOTHER = b"ours", b"another"
PERIOD = 10_000_000


class Graph:
    """A node's view of the publishers of /ev/imu: gid and full name of the node."""

    def __init__(self, **names: str) -> None:
        self.names = names

    def get_namespace(self) -> str:
        return "/ev"

    def resolve_topic_name(self, name: str) -> str:
        return f"/ev/{name}"

    def get_publishers_info_by_topic(self, _topic: str) -> list[SimpleNamespace]:
        return [
            SimpleNamespace(endpoint_gid=gid.encode(), node_namespace="/ev", node_name=name)
            for gid, name in self.names.items()
        ]


@pytest.fixture
def wall(monkeypatch):
    clock = [10.0]
    monkeypatch.setattr(speaker_module.time, "monotonic", lambda: clock[0])
    return clock


def heard(speaker: Speaker, gid: bytes) -> bool:
    return speaker.admits({"publisher_gid": {"data": gid}})


def test_only_the_node_of_the_role_is_read_and_another_one_is_named_once_for_each_look(wall):
    lines: list[str] = []
    speaker = Speaker(
        Graph(ours="plant", another="stranger"), "imu", "plant", lambda _, line: lines.append(line)
    )
    assert heard(speaker, OURS)
    assert not heard(speaker, ANOTHER)
    assert not heard(speaker, ANOTHER)
    assert lines == ["/ev/stranger is refused: /ev/imu is for /ev/plant alone"]
    assert speaker.refused == 2


def test_a_sender_is_read_once_its_node_is_known_and_named_when_that_takes_long(wall):
    """The middleware tells the node of a publisher some milliseconds after the publisher, as a rule."""
    graph, lines = Graph(ours="_NODE_NAME_UNKNOWN_"), []
    speaker = Speaker(graph, "imu", "plant", lambda _, line: lines.append(line))
    for _ in range(29):
        assert not heard(speaker, OURS)
        wall[0] += 0.1
    assert lines == []
    for _ in range(3):
        assert not heard(speaker, OURS)
        wall[0] += 0.1
    assert set(lines) == {"a sender on /ev/imu is not admitted: the graph does not name its node"}
    graph.names["ours"] = "plant"
    assert heard(speaker, OURS)


def reader_of(payloads: list[bytes]) -> Reader:
    """A reader of messages from these publishers, one of which may write."""
    reader, left = object.__new__(Reader), iter(payloads)
    reader.speaker = Speaker(
        Graph(ours="plant", another="stranger"), "imu", "plant", lambda *_: None
    )

    def take():
        gid = next(left, None)
        return (
            None
            if gid is None
            else (b"", {"publisher_gid": {"data": gid}, "received_timestamp": 1})
        )

    reader._take = take
    return reader


def test_a_flood_of_refused_messages_does_not_keep_the_node_from_all_else(wall):
    """A flood of refused messages ends a look.

    The plant's message behind them is found in the next.
    """
    reader = reader_of([ANOTHER] * (QUEUE_DEPTH + 10) + [OURS] + [ANOTHER] * QUEUE_DEPTH)
    assert reader.take() is None
    assert reader.take() == b""
    assert reader.take() is None
    assert reader.speaker.refused == 2 * QUEUE_DEPTH + 10


def test_a_master_that_was_restarted_before_time_went_on_is_named(wall):
    """Its state at 0 has the stamp of the one before.

    Nodes that have answered that would take it for a repetition.
    """
    graph, warnings = Graph(ours="plant"), []
    reception = Reception(
        Stepper(find_method("asr", "off"), lambda: None, PERIOD),
        SimpleNamespace(warn=warnings.append),
        print,
    )
    inbox = reception._stepper.inbox
    speakers = [
        Speaker(graph, "imu", "plant", lambda *_: None, reception.note_new_master) for _ in range(2)
    ]
    for others, stamp, named in ((b"1", None, 0), (b"2", PERIOD, 0), (b"3", 0, 1), (b"4", 0, 2)):
        inbox.expect(0 if stamp is None else stamp + PERIOD)
        for speaker, gid in zip(speakers, (others * 12 + b"a", others * 12 + b"b"), strict=True):
            graph.names = {gid.decode(): "plant"}
            wall[0] += 1.0
            assert heard(speaker, gid)
        assert len(warnings) == named
    assert warnings[0].startswith("plant was started again at 0 s")


def test_a_message_without_an_identity_is_of_no_other_publisher(wall):
    """Executors of rclpy pass on none.

    What is read with one before or afterwards has the same publisher.
    """
    successors: list[bytes] = []
    speaker = Speaker(Graph(ours="plant"), "imu", "plant", lambda *_: None, successors.append)
    for gid in (b"", OURS, b"", OURS):
        wall[0] += 1.0
        assert heard(speaker, gid)
    assert successors == []
