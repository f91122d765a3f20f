"""Bags of real time, of hardware and of other recorders, as far as they can be replayed."""

from __future__ import annotations

import os
import re
import resource
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from replay.bags import PERIOD, differences, foreign_bag, realtime_bag
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2 import reader as rosbags_reader
from rosbags.typesys import Stores, get_typestore

import ev_study.replay.recorded
from ev_core.parameters.data_file import MEGABYTE
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.recording import load
from ev_stack.scenarios.scenario import Overrides
from ev_study.replay.comparing import in_words, latency_of
from ev_study.replay.graph import replay_of
from ev_study.replay.recorded import find_recorded

PART = {
    "/a/wheel_states": "wheel_states",
    "/a/torque_request": "torque_request",
    "/a/torque_command": "torque_command",
}
STEPS = [PERIOD * step for step in range(20)]


def test_bag_in_real_time_keeps_arrivals_and_compares_where_both_sides_are_known(
    turn: Path, tmp_path: Path
):
    folder = realtime_bag(
        load(turn / "signals.npz"), tmp_path, {"torque_request": 1050, "driver/command": 1060}
    )
    shutil.copy(turn / "parameters.yaml", folder)
    recorded = find_recorded(folder)
    assert [note.partition(" of")[0] for note in recorded.notes] == [
        "driver/command: 1", "torque_request: 1"
    ]  # fmt: skip
    found = differences(recorded, tmp_path / "out", "electronic_differential")
    assert {each.compared for each in found} == {1101 - 2} and in_words(found).startswith(
        "bit-identical"
    )
    timing = latency_of(recorded)
    for topic, expected in (
        ("torque_request", 0.001),
        ("torque_command", 0.001),
        ("driver/command", 0.002),
    ):
        assert (
            timing["latency"][topic]["median"]
            == timing["latency"][topic]["largest"]
            == pytest.approx(expected)
        )
    # The column answers the driver of the instant before, recorded 7 ms before it.
    assert timing["latency"]["steering_column/state"]["median"] == pytest.approx(0.007)
    assert sum(timing["jitter"]["torque_request"]["counts"]) == 1100 - 2
    assert timing["jitter"]["wheel_states"]["largest"] == 0.0


def test_a_part_of_a_graph_is_replayed_from_any_namespace_and_start(turn: Path, tmp_path: Path):
    both = {**PART, "/b/wheel_states": "wheel_states", "/chatter": "imu"}
    late = [7_000_000_000 + stamp for stamp in STEPS]
    folder = foreign_bag(load(turn / "signals.npz"), tmp_path, late, both)
    with pytest.raises(ParameterError, match=r"\(--namespace\), the bag has those of /a, /b$"):
        find_recorded(folder)
    recorded = find_recorded(folder, "/a")
    assert recorded.period == PERIOD and [topic.name for topic in recorded.topics] == list(
        PART.values()
    )
    assert recorded.notes == ("time counts from the stamp 7 s on, the first one of all topics",)
    assert (
        in_words(differences(recorded, tmp_path / "out", "asr", "audi_a2"))
        == "bit-identical: 8 channels at 20 instants"
    )
    with pytest.raises(
        ParameterError,
        match="has no steering_column/state, which the asr pi_slip reads; it has wheel_",
    ):
        replay_of(recorded, "asr", "pi_slip", Overrides(vehicle="audi_a2"))


def test_parameters_of_another_namespace_are_refused(turn: Path, tmp_path: Path):
    """The role would be played by its default method with its default parameters."""
    folder = foreign_bag(load(turn / "signals.npz"), tmp_path, STEPS, PART)
    shutil.copy(turn / "parameters.yaml", folder)
    recorded = find_recorded(folder)
    line = r"parameters.yaml has parameters for /ev\S*/asr, expected for /a/asr, as the topics of "
    with pytest.raises(ParameterError, match=line):
        replay_of(recorded, "asr", "", Overrides())


@pytest.mark.parametrize(
    ("stamps", "message"),
    [
        ([*STEPS, *STEPS], "wheel_states goes back from 0.19 s to 0 s, expected a bag of one run"),
        (
            [*STEPS, 201_000_000],
            "wheel_states at 0.201 s, expected multiples of 0.01 s from 0 s on",
        ),
        ([0], "holds 1 whole instants of a run, expected two or more"),
    ],
)
def test_a_bag_that_is_no_single_run_in_steps_is_one_line(
    stamps, message, turn: Path, tmp_path: Path
):
    with pytest.raises(ParameterError) as error:
        find_recorded(foreign_bag(load(turn / "signals.npz"), tmp_path, stamps, PART))
    assert str(error.value).endswith(message)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux keeps such a limit")
def test_a_chunk_that_unfolds_to_more_than_the_bound_is_one_line(monkeypatch, tmp_path: Path):
    """Zeros of 128 MB are a file of some kB, which no bound of its size keeps out.

    They fit beside the bound where the process has as much memory that was freed before. Then the
    size of the message is refused.
    """
    refused = "unfolded it takes more than 64 MB|its messages are larger than 32 MB"
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer as bag:
        connection = bag.add_connection(
            "/imu", "sensor_msgs/msg/Imu", typestore=get_typestore(Stores.ROS2_HUMBLE)
        )
        bag.write(connection, 0, bytes(128 * MEGABYTE))
    assert sum(path.stat().st_size for path in (tmp_path / "bag").iterdir()) < MEGABYTE
    monkeypatch.setattr(ev_study.replay.recorded, "SIGNALS", 32 * MEGABYTE)
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with pytest.raises(ParameterError, match=rf"bag: the bag cannot be read: ({refused})$"):
        find_recorded(tmp_path / "bag")
    assert resource.getrlimit(resource.RLIMIT_DATA) == before


@pytest.mark.parametrize("kind", ["pipe", "unfolds"])
def test_what_a_bag_names_is_a_file_that_fits_on_the_disk(
    kind, turn: Path, tmp_path: Path, monkeypatch
):
    """Metadata may name a pipe without an end, or a compressed file of any size."""
    bag = foreign_bag(load(turn / "signals.npz"), tmp_path, STEPS, PART) / "bag"
    metadata = bag / "metadata.yaml"
    (storage,) = (path for path in bag.iterdir() if path != metadata)
    content = metadata.read_text().replace(storage.name, "other")
    if kind == "pipe":
        os.mkfifo(bag / "other")
    else:
        (bag / "other").write_bytes(rosbags_reader.zstd.compress(bytes(16 * MEGABYTE)))
        content = re.sub("compression_mode:.*", "compression_mode: FILE", content)
        content = re.sub("compression_format:.*", "compression_format: zstd", content)
        monkeypatch.setattr(ev_study.replay.recorded, "SIGNALS", 4 * MEGABYTE)
        # no limit of memory
        monkeypatch.setattr(ev_study.replay.recorded, "sys", SimpleNamespace(platform="other"))
    metadata.write_text(content)
    with pytest.raises(
        ParameterError, match="it is a pipe" if kind == "pipe" else "File too large"
    ):
        find_recorded(bag)
