"""Bags as the recorder writes them in real time, and as others do; what a replay finds in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS
from ev_stack.recording.bag_writer import BagWriter
from ev_stack.recording.recording import Recording
from ev_stack.recording.run_recorder import RecorderParameters, RunRecorder
from ev_stack.recording.spool import MessageTable
from ev_stack.running.offline import drive_offline
from ev_stack.running.output_folder import new_or_empty
from ev_stack.scenarios.scenario import Overrides
from ev_study.replay.graph import prepared, replay_of
from ev_study.replay.recorded import Recorded

PERIOD = 10_000_000  # ns, of shchur2019


def differences(recorded: Recorded, out: Path, role: str, vehicle: str | None = None):
    replay = replay_of(recorded, role, "", Overrides(vehicle=vehicle))
    return replay.differences(drive_offline(prepared(replay, new_or_empty(out))).recording)


def realtime_bag(of: Recording, folder: Path, lost: dict[str, int]) -> Path:
    """A folder with a bag of a recorder in real time; `lost`: topics without one instant.

    All of it is 20 ms late, the driver 2 ms after the plant, and so on.
    """
    # ms
    after = {
        "driver/command": 2,
        "torque_request": 3,
        "torque_command": 4,
        "steering_column/state": -1,
    }
    topics = [TOPICS[s] for s in RECORDED if set(TOPICS[s].channels) <= set(of.channels)]
    p = RecorderParameters(str(folder), control_period=PERIOD / 1e9, mode="realtime")
    recorder = RunRecorder(p, topics, [f"/ev/{t.name}" for t in topics])
    frames = frame.stack(len(of.time), PERIOD)
    for topic in topics:
        frames[:, frame.PLACES[topic.signal]] = np.stack(
            [of.channels[name] for name in topic.channels], axis=1
        )
    at = np.arange(len(of.time)) * PERIOD
    messages = [MessageTable(topic).serialize(at, frames) for topic in topics]
    for step in range(len(of.time)):
        for index, topic in enumerate(topics):
            if lost.get(topic.name) != step:
                late = 20 + after.get(topic.name, 0)
                recorder.add(
                    index,
                    [messages[index][step]],
                    [10**18 + int(at[step]) + late * 1_000_000],
                    print,
                )
    recorder.close()
    return folder


def foreign_bag(of: Recording, folder: Path, stamps: list[int], names: dict[str, str]) -> Path:
    """A bag of another recorder with a part of the graph: topics by full name, stamps [ns]."""
    with BagWriter(folder / "bag") as bag:
        for full, name in names.items():
            topic = next(topic for topic in TOPICS.values() if topic.name == name)
            numbers = np.zeros((len(stamps), frame.SIZE))
            numbers[:, frame.PLACES[topic.signal]] = np.stack(
                [of.channels[each][: len(stamps)] for each in topic.channels], axis=1
            )
            handle = bag.add_topic(full, topic.message_type)
            for i, message in enumerate(MessageTable(topic).serialize(np.array(stamps), numbers)):
                bag.write(handle, 10**18 + i * PERIOD, message)
    return folder
