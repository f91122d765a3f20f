"""Whole graphs as programs on three processors have the published hashes.

docs/determinism.md has all scenarios.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from documentation.hashes import HASHES, published_hashes
from documentation.processors import DRIVEN, hash_on
from ev_doors.export.targets import TARGETS
from ev_stack.scenarios.scenario import load_scenario

PUBLISHED = published_hashes((Path(__file__).parents[3] / HASHES).read_text())
RUNS = (("shchur2019", "shchur2019"), ("shchur2019_steps", "object"), ("steer_by_wire", "by_wire"))

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def objects(tmp_path_factory):
    """The object files, which the runs share."""
    return tmp_path_factory.mktemp("objects")


@pytest.mark.parametrize("target", DRIVEN)
@pytest.mark.parametrize("key", RUNS, ids=lambda key: key[0])
@pytest.mark.sampled
def test_a_published_hash_is_met(key, target, objects):
    for needed in (TARGETS[target].compiler, *TARGETS[target].emulator[:1]):
        if not shutil.which(needed):
            pytest.skip(f"{needed} is not installed")
    scenario, name = key
    (run,) = load_scenario(scenario, only=[name]).runs
    folder = objects / target
    folder.mkdir(exist_ok=True)
    assert hash_on(run, TARGETS[target], folder).startswith(PUBLISHED[key])
