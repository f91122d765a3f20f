"""The published hashes are those of the runs (docs/signal_hashes.md)."""

from __future__ import annotations

from pathlib import Path

import pytest

import ev_stack
from documentation.hashes import HASHES, changes, hash_table, published_hashes
from ev_core.parameters.data_file import files_in_config
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import load_scenario

PUBLISHED = published_hashes((Path(__file__).parents[3] / HASHES).read_text())
QUICK = ("double_lane_change", "shchur2019_steps", "step_steer", "tatar_chudzik", "zhileykin2018")


@pytest.mark.parametrize(
    ("scenario", "run"),
    [pytest.param(*key, marks=() if key[0] in QUICK else pytest.mark.slow) for key in PUBLISHED],
    ids=lambda word: word,
)
def test_a_published_hash_is_that_of_the_run(scenario, run):
    """A change that moves it goes into the page and, with its cause, into CHANGELOG."""
    (found,) = [each for each in load_scenario(scenario).runs if each.name == run]
    assert signal_hash(run_offline(found.configurations, found.duration)).startswith(
        PUBLISHED[scenario, run]
    )


def test_the_hash_of_a_copy_under_another_name_is_that_of_the_signals(tmp_path):
    """The name of the file is none of the signals.

    The printed hash of one run is that of the page.
    """
    copy = tmp_path / "another_name.yaml"
    copy.write_bytes(files_in_config("scenarios")["step_steer"].read_bytes())
    only_one, copied = (
        ev_stack.run(name, runs=["left"], duration=0.5) for name in ("step_steer", copy)
    )
    assert copied.hash == only_one.hash == signal_hash(only_one.runs["left"])
    both, copied = (ev_stack.run(name, duration=0.5) for name in ("step_steer", copy))
    assert copied.hash == both.hash != only_one.hash
    lane_change = tmp_path / "b.yaml"
    lane_change.write_bytes(files_in_config("scenarios")["double_lane_change"].read_bytes())
    assert ev_stack.run(lane_change).hash.startswith(
        PUBLISHED["double_lane_change", "double_lane_change"]
    )


def test_every_run_of_every_scenario_is_published():
    assert set(PUBLISHED) == {
        (name, run.name) for name in scenario_names() for run in load_scenario(name).runs
    }


def test_a_table_is_read_as_it_was_written():
    hashes = {("step_steer", "left"): "0123456789ab", ("step_steer", "right"): "ba9876543210"}
    assert published_hashes(hash_table(hashes)) == hashes


def test_a_change_names_run_and_hashes():
    before = {("a", "same"): "00", ("a", "moved"): "01", ("a", "lost"): "02"}
    now = {("a", "same"): "00", ("a", "moved"): "11", ("b", "more"): "03"}
    assert changes(before, now) == [
        "a / moved: 01 -> 11",
        "a / lost: 02 -> gone",
        "b / more: new -> 03",
    ]
