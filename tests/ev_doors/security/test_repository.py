"""Workflows and container take others' work by content, not by movable name; few rights."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[3]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.y*ml"))
DIGEST = re.compile(r"sha256:[0-9a-f]{64}")


@pytest.fixture(params=WORKFLOWS, ids=lambda path: path.name)
def workflow(request: pytest.FixtureRequest) -> Path:
    return request.param


def jobs_of(workflow: Path) -> Iterator[dict[str, Any]]:
    yield from yaml.safe_load(workflow.read_text())["jobs"].values()


def test_actions_are_named_by_commit_with_their_version_beside(workflow):
    used = re.findall(r"uses: *(.*)", workflow.read_text())
    assert used
    assert [
        each for each in used if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", each)
    ] == []


def test_workflows_may_read_and_nothing_else(workflow):
    assert yaml.safe_load(workflow.read_text())["permissions"] == {"contents": "read"}
    for job in jobs_of(workflow):
        assert "permissions" not in job
        for step in job["steps"]:
            if step.get("uses", "").startswith("actions/checkout@"):
                assert step["with"]["persist-credentials"] is False


def test_containers_of_workflows_are_named_by_digest(workflow):
    for job in jobs_of(workflow):
        if "container" in job:
            assert job["container"].endswith("@${{ matrix.digest }}")
            assert all(
                DIGEST.fullmatch(each["digest"]) for each in job["strategy"]["matrix"]["include"]
            )


def test_the_container_has_a_base_by_digest_and_does_not_run_as_root():
    lines = (ROOT / "Dockerfile").read_text().splitlines()
    bases = [line for line in lines if line.startswith("FROM ")]
    assert bases and all(DIGEST.fullmatch(line.partition("@")[2]) for line in bases)
    users = [line.split()[1] for line in lines if line.startswith("USER ")]
    assert users and users[-1] not in ("root", "0")
