"""The line between a node and its runner: reports arrive, and nothing that is no report."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_nodes.stepping.runner_line import (
    NOTE,
    PROGRESS,
    RUNNER_LINE,
    WARNING,
    WORD_KINDS,
    RunnerLine,
    Word,
)
from ev_stack.running.node_reports import NodeReports
from ev_stack.running.node_reports import node_reports as opened


@pytest.fixture
def reports(monkeypatch):
    """Reports of a node of this process, and the end of the line."""
    words = NodeReports("/ev")
    address, _ = words.line("asr")
    monkeypatch.setenv(RUNNER_LINE, address)
    yield words
    words.close()


def test_the_reports_of_a_node_arrive_with_its_name(reports):
    line = RunnerLine()
    reports.started("asr")
    line.tell(Word(WARNING, "something is odd"))
    line.tell(Word(NOTE, "refused", "stranger"))
    line.tell(Word(NOTE, "refused again", "stranger"))
    line.tell(Word(PROGRESS, values={"stamp": 1_500_000_000}))
    line.close()
    reports.look()
    assert reports.warnings == ("/ev/asr: something is odd",)
    assert reports.notes == ("/ev/asr: refused",)
    assert reports.time == 1.5


def test_a_runner_that_does_not_listen_holds_nobody_up_and_loses_no_word_but_old_progress(reports):
    """It may be stopped for a while.

    Thousands of words do not fit into a socket, and one that never will is left out.

    Of warnings the first ones are named, and all are counted. The newest progress comes through.
    """
    line = RunnerLine()
    line.tell(Word(WARNING, "x" * 10_000_000))
    for n in range(5000):
        line.tell(Word(WARNING, f"{n}"))
        line.tell(Word(WARNING, "0"))
        line.tell(Word(PROGRESS, values={"stamp": n}))
    while reports.warnings[-1:] != ("4980 more warnings, which are in /diagnostics",):
        reports.look()
        line.send_what_waits()
    assert reports.warnings[:-1] == tuple(f"/ev/asr: {n}" for n in range(20))
    reports.look()
    assert reports.time == pytest.approx(4999e-9)
    line.close()


def test_progress_goes_on_when_a_runner_listens_again(reports):
    """A recorder has no other words: its progress is there behind three seconds of Ctrl-Z."""
    line = RunnerLine()
    for stamp in range(0, 3_000_000, 1000):
        line.tell(Word(PROGRESS, values={"stamp": stamp}))
    reports.look()
    line.tell(Word(PROGRESS, values={"stamp": 3_000_000}))
    reports.look()
    assert reports.time == 0.003
    line.close()


def test_what_was_noted_is_said_though_the_run_is_interrupted(capsys):
    """Ctrl-C loses no notes: each is printed once, with what came last."""
    with pytest.raises(KeyboardInterrupt), opened("/ev") as words:
        _, number = words.line("asr")
        for what in ("first", "last"):
            os.write(number, Word(NOTE, f"{what} stranger is refused", what).encoded())
        raise KeyboardInterrupt
    assert capsys.readouterr().err.splitlines() == [
        f"note: /ev/asr: {w} stranger is refused" for w in ("first", "last")
    ]


def test_a_child_finds_its_end_and_no_other_process_does(reports):
    """The end is inherited; its name in an environment alone opens nothing."""
    words = [
        "import sys",
        "from ev_nodes.stepping.runner_line import NOTE, RunnerLine, Word",
        "line = RunnerLine()",
        "line.tell(Word(NOTE, sys.argv[1], sys.argv[1]))",
        "line.close()",
    ]
    reports.close()
    address, inherited = reports.line("asr")
    for name, descriptors in (("child", [inherited]), ("stranger", [])):
        environment = {**os.environ, RUNNER_LINE: address}
        command = [sys.executable, "-c", "\n".join(words), name]
        subprocess.run(command, env=environment, pass_fds=descriptors, check=True)
    reports.look()
    assert reports.notes == ("/ev/asr: child",)


@pytest.mark.parametrize("address", ["", "7", "x y z", "99999 1", "0 x"])
def test_a_node_without_a_runner_tells_nobody(address, monkeypatch):
    monkeypatch.setenv(RUNNER_LINE, address)
    line = RunnerLine()
    line.tell(Word(WARNING, "no one is listening"))
    line.close()


def test_another_socket_under_the_number_is_no_line(monkeypatch):
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    monkeypatch.setenv(RUNNER_LINE, f"{theirs.fileno()} {os.getpid()}")
    RunnerLine().tell(Word(WARNING, "x"))
    ours.setblocking(False)
    with pytest.raises(BlockingIOError):
        ours.recv(10)
    ours.close()
    theirs.close()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=8,
)
VALUES = (
    st.dictionaries(st.sampled_from(["stamp", "rests", "whom", "why", "x"]), JSON, max_size=3)
    | JSON
)
WORDS = st.dictionaries(
    st.sampled_from(["kind", "text", "what", "values", "more"]), JSON | st.sampled_from(WORD_KINDS)
)


@given(
    written=st.binary(max_size=30)
    | (
        WORDS
        | JSON
        | st.builds(lambda k, v: {"kind": k, "values": v}, st.sampled_from(WORD_KINDS), VALUES)
    ).map(lambda j: json.dumps(j).encode())
)
def test_whatever_is_said_there_is_a_word_or_is_noted_in_one_line(written):
    reports = NodeReports("/ev")
    _, number = reports.line("asr")
    os.write(number, written or b" ")
    reports.look()
    assert all(
        text.isprintable() and len(text) < 300
        for text in (*reports.notes, *reports.warnings, *reports.new_words())
    )
    reports.close()
