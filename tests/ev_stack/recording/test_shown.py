"""Views in a bag: whole instants of one run; in real time a missing value is held."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.stamps import RUN
from ev_msgs_py.contract.topics import TOPICS
from ev_stack.recording.recording import Recording
from ev_stack.recording.run_recorder import RecorderParameters, RunRecorder
from ev_stack.recording.shown import Message, View
from ev_stack.recording.spool import MessageTable

PERIOD = 10_000_000  # ns
NAMES = ("imu", "driver/command")  # the first one is the master's
USED = [topic for name in NAMES for topic in TOPICS.values() if topic.name == name]
LASTS, MOVES = (
    View("/lasts", "std_msgs/msg/Header", lasts=True),
    View("/moves", "std_msgs/msg/Header"),
)
YAW_RATE, DRIVE = "imu.yaw_rate", "driver.command.drive_torque"


class Numbers:
    """Shows two channels as text behind a comma, in messages that are nothing else."""

    def lasting(self):
        yield Message(LASTS, b"once")

    def moving(self, stamps_ns: np.ndarray, run: Recording):
        rows = zip(stamps_ns, run.channels[YAW_RATE], run.channels[DRIVE], strict=True)
        yield (
            MOVES,
            [f"{stamp // 1_000_000},{yaw:g},{drive:g}".encode() for stamp, yaw, drive in rows],
        )


def recorder_in(folder: Path, mode: str) -> RunRecorder:
    p = RecorderParameters(str(folder), control_period=PERIOD / 1e9, mode=mode)
    return RunRecorder(p, USED, NAMES, Numbers())


def take(recorder: RunRecorder, index: int, step: int, value: float, run: int = 0) -> None:
    sent = MessageTable(USED[index]).serialize(
        np.array([step * PERIOD + run]), np.full((1, frame.SIZE), value)
    )
    recorder.add(index, sent, [10**18 + step * PERIOD], lambda error: pytest.fail(str(error)))


def shown_in(bag: Path) -> list[tuple[int, str]]:
    """Shown views by time."""
    with AnyReader([bag]) as reader:
        wanted = [each for each in reader.connections if each.topic in ("/lasts", "/moves")]
        return [(at, bytes(data).decode()) for _, at, data in reader.messages(wanted)]


def test_instants_are_shown_whole_and_every_other_one_of_10_ms(tmp_path):
    recorder = recorder_in(tmp_path, "lockstep")
    for step in range(60):
        take(recorder, 0, step, step)
        if step:  # the driver is an instant behind
            take(recorder, 1, step - 1, 2 * (step - 1))
        recorder.took_all()
    recorder.close()
    expected = [
        (0, "once"),
        *((step * PERIOD, f"{step * 10},{step},{2 * step}") for step in range(0, 59, 2)),
    ]
    assert sorted(shown_in(tmp_path / "bag")) == sorted(expected)


def test_in_real_time_an_instant_has_the_time_at_which_it_came_and_holds_what_has_not(tmp_path):
    recorder = recorder_in(tmp_path, "realtime")
    for step in range(7):
        take(recorder, 0, step, step)
        if step < 2 or step == 6:
            take(recorder, 1, step, 5.0 + step)
    recorder.close()
    expected = [(0, "0,0,5"), (2, "20,2,5"), (4, "40,4,5"), (6, "60,6,11")]
    assert [each for each in shown_in(tmp_path / "bag") if each[1] != "once"] == [
        (10**18 + step * PERIOD, text) for step, text in expected
    ]


def test_the_bag_of_each_run_shows_that_run_alone(tmp_path):
    recorder = recorder_in(tmp_path, "lockstep")
    for run, steps in ((0, 4), (RUN, 2)):
        for step in range(steps):
            for index in range(2):
                take(recorder, index, step, 1.0 + run / RUN, run)
    recorder.close()
    before, after = (shown_in(tmp_path / name) for name in ("bag_before_reset_1", "bag"))
    assert sorted(before) == [(0, "0,1,1"), (0, "once"), (2 * PERIOD, "20,1,1")]
    assert sorted(after) == [(0, "0,2,2"), (0, "once")]
