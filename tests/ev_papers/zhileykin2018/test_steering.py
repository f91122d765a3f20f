"""The law with active front steering, where either alone loses the car."""

from __future__ import annotations

import argparse

import pytest

from ev_papers.zhileykin2018 import grid, steering
from ev_study.studies.study import drive_case

pytestmark = pytest.mark.slow

GIVEN = argparse.Namespace()


def sideslip(control: str, force: float, angle: float, how: str) -> float:
    """Largest sideslip angle of one case of the study [rad]."""
    name = grid.name_of(control, force, angle, how)
    (case,) = (case for case in steering.cases(GIVEN) if case.name == name)
    peak: float = drive_case(case, steering.measure).measured["peak_sideslip"]
    return peak


def test_every_control_with_both_steerings():
    assert len(steering.cases(GIVEN)) == 2 * len(grid.CONTROLS) * grid.SIZE


def test_both_hold_where_neither_alone_does():
    """3500 N and 7 deg.

    Rear drive with steering and the law with k = 0.5 alone lose the car, together they hold it.
    """
    limit = grid.LIMIT
    assert sideslip("rear_drive", 3500.0, 7, "added") > limit
    assert sideslip("k05", 3500.0, 7, "hands") > limit
    assert sideslip("k05", 3500.0, 7, "added") < limit


def test_the_one_case_that_the_law_loses_with_k_1_is_held():
    """3500 N and 8 deg."""
    assert sideslip("k1", 3500.0, 8, "hands") > grid.LIMIT > sideslip("k1", 3500.0, 8, "added")
