"""Ratios of benchmarks: by alternating rounds, and none where the rounds do not decide."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

# By its file: on the path, benchmarks/plant.py would hide the folder of the plant's tests.
_ROUNDS = SimpleNamespace(
    **runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "rounds.py"))
)
FEWEST, alternating = _ROUNDS.FEWEST, _ROUNDS.alternating
as_json, ratio_of = _ROUNDS.as_json, _ROUNDS.ratio_of
TIMES = st.lists(st.floats(1e-6, 1e3), min_size=1, max_size=12)


def test_rounds_alternate_behind_a_first_one_that_does_not_count():
    order = []
    measures = {name: lambda name=name: order.append(name) or float(len(order)) for name in "AB"}
    found = alternating(measures, 2)
    assert order == ["A", "B"] * 3
    assert found == {"A": [3.0, 5.0], "B": [4.0, 6.0]}


@given(times=TIMES, speeds=st.lists(st.floats(0.1, 10.0), min_size=12, max_size=12))
def test_a_ratio_does_not_depend_on_how_fast_the_machine_is_in_a_round(times, speeds):
    """A slow round is slow for both: the ratio of equal work stays what it is."""
    slowed = [time * speed for time, speed in zip(times, speeds, strict=False)]
    ratio = ratio_of([2.0 * each for each in slowed], slowed)
    assert (ratio.median, ratio.spread) == pytest.approx((2.0, 0.0))
    assert (ratio.value is None) == (len(times) < FEWEST)


@given(of=TIMES, goal=st.floats(0.1, 10.0))
def test_a_ratio_is_reported_where_its_spread_decides(of, goal):
    """A line has the number or the reason, and a file the number or null."""
    ratio = ratio_of(of, [1.0] * len(of), goal)
    assert ratio.low <= ratio.median <= ratio.high
    decided = len(of) >= FEWEST and ratio.spread <= abs(ratio.median - goal)
    assert (as_json(ratio)["ratio"] is not None) == decided
    assert bool(re.match(r"[\d.]+ \(spread [\d.]+, goal ", str(ratio))) == decided
    assert str(ratio).startswith("not reported: ") != decided


def test_four_rounds_are_too_few():
    assert str(ratio_of([1.0] * 4, [1.0] * 4)) == "not reported: 4 of at least 5 rounds"
    assert ratio_of([1.0] * 5, [1.0] * 5).value == 1.0


def test_a_spread_larger_than_the_distance_from_the_goal_is_not_reported():
    """Middle half 1.00 to 1.20 around 1.10, the goal 0.05 away: either side is possible."""
    ratio = ratio_of([0.9, 1.0, 1.1, 1.2, 1.3], [1.0] * 5, goal=1.05)
    assert str(ratio) == "not reported: spread 0.20 larger than the distance from goal 1.05"
    assert ratio_of([0.9, 1.0, 1.1, 1.2, 1.3], [1.0] * 5, goal=2.0).value == 1.1
