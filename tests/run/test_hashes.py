"""The published hashes are those of the runs (docs/signal_hashes.md)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from ev_sim.run.offline import run_offline
from ev_sim.run.recording.recording import signal_hash
from ev_sim.run.scenarios.scenario import load_scenario, scenario_names

PAGE = Path(__file__).parents[2] / "docs" / "signal_hashes.md"
ROW = re.compile(r"\| (\w+) / (\w+) \| `\w+` \| `(\w{12})` \|")
PUBLISHED = ROW.findall(PAGE.read_text())
QUICK = ("double_lane_change", "ge_ni2005", "shchur2019_steps", "step_steer", "tatar_chudzik", "zhileykin2018")


@pytest.mark.parametrize(
    ("scenario", "run", "digits"),
    [pytest.param(*row, marks=() if row[0] in QUICK else pytest.mark.slow) for row in PUBLISHED],
    ids=lambda word: word,
)
def test_a_published_hash_is_that_of_the_run(scenario, run, digits):
    """A change of arithmetic that moves it belongs into the page and into CHANGELOG, with its cause."""
    (found,) = [each for each in load_scenario(scenario).runs if each.name == run]
    assert signal_hash(run_offline(found.configurations, found.duration)).startswith(digits)


def test_every_run_of_every_scenario_is_published():
    runs = {(name, run.name) for name in scenario_names() for run in load_scenario(name).runs}
    assert {(scenario, run) for scenario, run, _ in PUBLISHED} == runs
