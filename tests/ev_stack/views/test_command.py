"""Refusals of ev-stack visualization, before it looks for a car."""

from __future__ import annotations

import pytest

from ev_stack.commands.program import perform


@pytest.mark.parametrize(
    ("domain", "words", "line"),
    [
        ("-1", [], "ROS_DOMAIN_ID=-1 is refused, expected a whole number from 0 to 232"),
        ("", ["--ros-args", "--fly"], "unknown ROS arguments ['--fly']"),
    ],
)
def test_what_it_cannot_begin_with_is_one_line(domain, words, line, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(SystemExit) as ended:
        perform(["visualization", *words])
    assert ended.value.code == f"error: {line}"
