"""Performance profiles, probability of improvement, the front of undominated laws."""

from __future__ import annotations

import numpy as np
import pytest

from ev_study.benchmark.ranking.distributions import COSTS_SHOWN, improvement, performance_profiles
from ev_study.benchmark.ranking.drawing import undominated


def test_a_profile_is_the_share_of_runs_that_cost_no_more():
    """Costs 0.5, 1, 1.5 and 2 in one cell, 1 in all draws of another one.

    Half of them is known without a doubt.
    """
    costs = np.array([[[0.5, 1.0, 1.5, 2.0], [1.0, 1.0, 1.0, 1.0]]])
    value, low, high = (
        dict(zip(COSTS_SHOWN.round(2), of[0], strict=True)) for of in performance_profiles(costs, 1)
    )
    assert [value[x] for x in (0.45, 0.5, 1.0, 1.5, 3.0)] == [0.0, 0.125, 0.75, 0.875, 1.0]
    # one draw of four: none to three of them in 95 % of the boards
    assert (low[0.95], high[0.95]) == (0.0, 0.375)
    assert low[1.0] >= 0.5
    assert low[3.0] == high[3.0] == 1.0


def test_improvement_counts_draws_and_ties_count_half():
    """Better in one draw of four and equal in two of them: (1 + 2/2)/4.

    The other way round the rest.
    """
    one, other = np.array([[[1.0, 1.0, 1.0, 1.0]], [[0.9, 1.0, 1.0, 1.1]]])
    value, low, high = improvement(np.stack([one, other]), seed=1)
    assert value.tolist() == [[0.5, 0.5], [0.5, 0.5]]
    value, low, high = improvement(np.stack([one, other - 0.05]), seed=1)
    assert value[1, 0] == 0.75 == 1.0 - value[0, 1]
    assert low[1, 0] < 0.75 < high[1, 0]


def test_the_interval_of_an_improvement_is_that_of_a_share():
    """The share of 60 better draws of 100 deviates by 0.049, the bootstrap by 1.96 of it."""
    better = np.where(np.arange(100) < 60, 0.9, 1.1)[None, :]
    _, low, high = improvement(np.stack([np.ones((1, 100)), better]), seed=1)
    # of 1000 boards: ends to some per cent
    assert (high - low)[1, 0] == pytest.approx(2 * 1.96 * 0.049, rel=0.15)


def test_the_front_has_the_laws_that_no_other_one_dominates():
    """Two that are best in one number each, one of equal numbers twice, and one behind in both."""
    points = np.array([[1.0, 0.8], [0.9, 0.9], [0.9, 0.9], [1.0, 0.95]])
    assert undominated(points) == [0, 1, 2]
