"""The bag of a run without messages, when it is interrupted while it is written."""

from __future__ import annotations

import errno
import os
import re
import signal
from pathlib import Path

import pytest
from helpers.ros_graph import shchur
from rosbags.highlevel import AnyReader

from ev_stack.recording.bag_writer import BagWriter
from ev_stack.recording.offline import run_offline
from ev_stack.recording.run_recorder import write_bag
from ev_stack.running.offline import recorded_topics


@pytest.mark.parametrize("late", [False, True], ids=["on the way", "at the last message"])
def test_ctrl_c_leaves_a_bag_that_counts_what_it_holds(
    late, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Between a message and its count there is no place to be interrupted at.

    Nor is an interrupt lost.
    """
    run = shchur(0.5)
    topics = recorded_topics(run)
    recording = run_offline(run.configurations, run.duration)
    whole = len(topics) * len(recording.time)
    strikes = whole if late else whole // 2
    write, written = BagWriter.write, []

    def interrupted(bag: BagWriter, *message) -> None:
        written.append(message)
        if len(written) == strikes:
            signal.raise_signal(signal.SIGINT)
        write(bag, *message)

    monkeypatch.setattr(BagWriter, "write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_bag(recording, topics, [topic.name for topic in topics], run.period, tmp_path / "bag")
    with AnyReader([tmp_path / "bag"]) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages()) == len(written)
    assert strikes <= len(written) < strikes + len(topics)


def test_a_full_disk_names_the_bag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The system gives no name where a write fails; the user has several files in the folder."""
    run = shchur(0.1)
    topics = recorded_topics(run)
    recording = run_offline(run.configurations, run.duration)

    def full(_bag: BagWriter, *_message) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(BagWriter, "write", full)
    bag = tmp_path / "bag"
    with pytest.raises(OSError, match=re.escape(f"No space left on device: '{bag}'")):
        write_bag(recording, topics, [topic.name for topic in topics], run.period, bag)
