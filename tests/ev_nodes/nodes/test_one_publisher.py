"""Publishers admitted on a topic, by what the graph knows and a clock that the test turns."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_core.lockstep.stepper import Stepper
from ev_msgs_py.contract.topics import QUEUE_DEPTH
from ev_nodes.rcl.taking import Taken
from ev_nodes.stepping import signal_io
from ev_nodes.stepping.reception import Reception
from ev_nodes.stepping.signal_io import OnePublisher, Reader

OURS, ANOTHER = b"ours", b"another"
PERIOD = 10_000_000


class Graph:
    """A node's view of the publishers of /ev/imu: identity and name of the node."""

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


class Reported:
    """Reports of a node: notes change no number, warnings may."""

    def __init__(self) -> None:
        self.notes: list[str] = []
        self.warnings: dict[str, str] = {}

    def note(self, _what: str, text: str) -> None:
        self.notes.append(text)

    def warn_once(self, what: str, text: str) -> None:
        self.warnings[what] = text


@pytest.fixture
def wall(monkeypatch):
    clock = [10.0]
    monkeypatch.setattr(signal_io.time, "monotonic", lambda: clock[0])
    return clock


def judge_of(graph: Graph, reported: Reported | None = None) -> OnePublisher:
    return OnePublisher(graph, "imu", "plant", reported or Reported())


def test_the_node_of_the_role_is_admitted_and_another_one_is_named(wall):
    """The other one is named once for each look into the graph."""
    reported = Reported()
    judge = judge_of(Graph(ours="plant", another="stranger"), reported)
    assert judge.admits(OURS)
    assert not judge.admits(ANOTHER)
    assert not judge.admits(ANOTHER)
    assert reported.notes == ["/ev/stranger is refused: /ev/imu is for /ev/plant alone"]
    assert not reported.warnings
    assert judge.refused == 2


def test_a_second_node_of_the_name_is_refused_and_makes_the_run_not_reproducible(wall):
    """The right one of both is not known: the first one may have been the wrong one."""
    reported, graph = Reported(), Graph(ours="plant")
    judge = judge_of(graph, reported)
    assert judge.admits(OURS)
    graph.names["another"] = "plant"
    for _ in range(3):
        wall[0] += 1.0
        assert not judge.admits(ANOTHER)
        assert judge.admits(OURS)
    assert reported.notes == []
    assert reported.warnings == {
        "/ev/plant": "2 nodes are called /ev/plant, expected one: the run may not be reproducible"
    }


def test_of_two_nodes_of_the_name_that_were_there_before_none_is_admitted(wall):
    reported = Reported()
    judge = judge_of(Graph(ours="plant", another="plant"), reported)
    assert not judge.admits(OURS)
    assert not judge.admits(ANOTHER)
    assert len(reported.warnings) == 1


def test_a_restarted_node_takes_the_place_of_the_one_that_has_left(wall):
    reported, graph, successors = Reported(), Graph(ours="plant"), []
    judge = judge_of(graph, reported)
    judge.succeeded = successors.append
    assert judge.admits(OURS)
    graph.names = {"another": "plant"}
    assert judge.admits(ANOTHER)
    assert successors == [ANOTHER]
    assert not reported.notes and not reported.warnings


def test_a_publisher_whose_node_is_not_known_yet_is_admitted_when_it_is(wall):
    """The node of a publisher becomes known some milliseconds after it, as a rule."""
    reported, graph = Reported(), Graph(ours="_NODE_NAME_UNKNOWN_")
    judge = judge_of(graph, reported)
    for _ in range(29):
        assert not judge.admits(OURS)
        wall[0] += 0.1
    assert reported.notes == []
    for _ in range(3):
        assert not judge.admits(OURS)
        wall[0] += 0.1
    assert set(reported.notes) == {
        "a publisher of /ev/imu is refused: the graph does not name its node"
    }
    graph.names["ours"] = "plant"
    assert judge.admits(OURS)


NAMES = st.sampled_from(["plant", "stranger", "_NODE_NAME_UNKNOWN_"])
EVENTS = st.lists(
    st.tuples(st.sampled_from("abc"), st.none() | NAMES, st.sampled_from([0.0, 0.005, 0.3, 4.0])),
    max_size=30,
)


@given(EVENTS)
@settings(deadline=None)
def test_a_message_counts_only_if_one_node_alone_had_the_name_at_the_look(events):
    """Publishers come, leave, and are named late, in any order, and each sends after each event.

    At most one publisher is admitted at a time. Whenever a look finds several nodes of the name,
    that is reported, so that no message of a second one counts without a line.
    """
    clock, graph, reported = [0.0], Graph(), Reported()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(signal_io.time, "monotonic", lambda: clock[0])
        judge = judge_of(graph, reported)
        for gid, name, later in events:
            graph.names.pop(gid, None)
            if name is not None:
                graph.names[gid] = name
            clock[0] += later
            before = judge.admitted
            for other in graph.names:
                if judge.admits(other.encode()) and other.encode() != before:
                    plants = [each for each, of in graph.names.items() if of == "plant"]
                    assert plants == [other] or reported.warnings
            if later > 1.0 and list(graph.names.values()).count("plant") > 1:
                assert len(reported.warnings) == 1


def reader_of(senders: list[bytes]) -> Reader:
    """A reader of messages of these publishers, one of which is admitted."""
    reader, left = object.__new__(Reader), iter(senders)
    reader.judge = judge_of(Graph(ours="plant", another="stranger"))

    def take() -> Taken | None:
        gid = next(left, None)
        return None if gid is None else Taken(b"", gid, 1)

    reader._take = take
    return reader


def test_a_publisher_faster_than_it_is_refused_does_not_keep_the_node_from_all_else(wall):
    """The message of the plant is found behind those without end when the node looks again."""
    reader = reader_of([ANOTHER] * (QUEUE_DEPTH + 10) + [OURS] + [ANOTHER] * QUEUE_DEPTH)
    assert reader.take() is None
    assert reader.take() == b""
    assert reader.take() is None
    assert reader.judge.refused == 2 * QUEUE_DEPTH + 10


def test_a_master_that_was_started_again_before_time_went_on_is_named(wall):
    """Its state at 0 has the stamp of that of the master before: it would pass as a repetition."""
    graph, warnings = Graph(ours="plant"), []
    reception = Reception(
        Stepper(find_method("asr", "off"), lambda: None, PERIOD),
        SimpleNamespace(warn=warnings.append),
        print,
    )
    inbox = reception._stepper.inbox
    judges = [judge_of(graph) for _ in range(2)]
    for judge in judges:
        judge.succeeded = reception.note_new_master
    for others, stamp, named in ((b"1", None, 0), (b"2", PERIOD, 0), (b"3", 0, 1), (b"4", 0, 2)):
        inbox.expect(0 if stamp is None else stamp + PERIOD)
        for judge, gid in zip(judges, (others * 12 + b"a", others * 12 + b"b"), strict=True):
            graph.names = {gid.decode(): "plant"}
            wall[0] += 1.0
            assert judge.admits(gid)
        assert len(warnings) == named
    assert warnings[0].startswith("plant was started again at 0 s")


def test_a_message_without_an_identity_is_of_no_other_publisher(wall):
    """Executors of rclpy pass on none: such messages have the publisher of those with one."""
    successors: list[bytes] = []
    judge = judge_of(Graph(ours="plant"))
    judge.succeeded = successors.append
    for gid in (b"", OURS, b"", OURS):
        wall[0] += 1.0
        assert judge.admits(gid)
    assert successors == []


def test_a_message_without_an_identity_is_refused_where_another_node_publishes(wall):
    reported = Reported()
    judge = judge_of(Graph(ours="plant", another="stranger"), reported)
    assert not judge.admits(b"")
    assert reported.notes == ["/ev/stranger is refused: /ev/imu is for /ev/plant alone"]
