"""Costs against a reference, means of middle half and tail, ranks that noise cannot decide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ev_study.benchmark.board import read_board
from ev_study.benchmark.manoeuvre import Manoeuvre
from ev_study.benchmark.ranking.scores import (
    LARGEST,
    bootstrap,
    costs_of,
    interquartile_mean,
    ranked,
    tail_mean,
)

NONE_UNSTABLE = np.zeros((2, 3), bool)
BOARD = replace(read_board("small"), reference="without", scales={"peak_sideslip": 0.01})
MANOEUVRE = Manoeuvre("s", 1.0, [], handling=["peak_sideslip"], energy=[])


def costs(of_reference, of_law, unstable=NONE_UNSTABLE) -> np.ndarray:
    """Costs of a law beside the reference, by its sideslip [rad]."""
    metrics = {
        "without": {"peak_sideslip": np.array(of_reference)},
        "law": {"peak_sideslip": np.array(of_law)},
    }
    return costs_of(BOARD, MANOEUVRE, "handling", metrics, unstable)


def test_a_cost_is_a_ratio_and_the_reference_costs_one():
    """Half, twice, and five times, which is cut to 3."""
    assert costs([0.1, 0.1, 0.1], [0.05, 0.2, 0.5]).tolist() == [
        [1.0, 1.0, 1.0],
        pytest.approx([0.5, 2.0, LARGEST]),
    ]


def test_a_cost_without_metrics_is_one_unless_the_run_is_lost():
    unstable = np.array([[False, False, False], [False, True, False]])
    metrics = {"without": {}, "law": {}}
    assert costs_of(BOARD, MANOEUVRE, "energy", metrics, unstable).tolist() == [
        [1.0] * 3,
        [1.0, LARGEST, 1.0],
    ]


def test_what_is_below_the_scale_is_no_difference():
    """1e-9 against 1e-6 rad on a straight road is 1e-3 of 0.01 rad, not a factor of 1000."""
    assert costs([1e-9] * 3, [1e-6] * 3)[1] == pytest.approx([1.0001] * 3)


def test_lost_and_unstable_runs_cost_most():
    """A number that is not there, a run that is unstable.

    Where only the reference has none, it says nothing.
    """
    unstable = np.array([[False, False, False], [False, True, False]])
    found = costs([0.1, 0.1, np.nan], [np.nan, 0.05, 0.05], unstable)
    assert found.tolist() == [[1.0, 1.0, LARGEST], [LARGEST, LARGEST, 1.0]]


def test_the_middle_half_and_the_worst_tenth():
    """1 to 20: the middle half is 6 to 15, the worst tenth 19 and 20."""
    values = np.arange(20.0, 0.0, -1.0)
    assert interquartile_mean(values) == 10.5
    assert tail_mean(values) == 19.5


def test_nothing_is_better_within_the_noise():
    """Two laws of one distribution share a rank; a third, better by a tenth, is first."""
    random = np.random.default_rng(1)
    alike = 1.0 + 0.2 * random.standard_normal((2, 6, 20))
    found = ranked(bootstrap(np.concatenate([alike, alike[:1] - 0.1]), interquartile_mean, seed=1))
    assert [each.rank for each in found] == [2, 2, 1]
    assert all(each.low < each.value < each.high for each in found)


def test_paired_draws_tell_apart_what_their_intervals_do_not():
    """Draws differ by far more than the laws: intervals overlap, differences do not."""
    random = np.random.default_rng(2)
    one = 1.0 + 0.5 * random.standard_normal((1, 4, 20))
    better, worse = ranked(bootstrap(np.concatenate([one, one + 0.02]), interquartile_mean, seed=1))
    assert worse.low < better.high
    assert (better.rank, worse.rank) == (1, 2)


@pytest.mark.parametrize("statistic", [interquartile_mean, tail_mean])
def test_a_law_has_the_same_boards_beside_any_others(statistic):
    """A division is ranked by the columns of its laws, to the bit."""
    costs = np.random.default_rng(5).lognormal(size=(5, 3, 37))
    some = [3, 0]
    assert (
        bootstrap(costs[some], statistic, seed=1).tolist()
        == bootstrap(costs, statistic, seed=1)[:, some].tolist()
    )


def test_the_interval_holds_the_true_mean_about_as_often_as_it_says():
    """38 of 40 boards of 3 cells with 20 draws are expected; 4 standard deviations are 6."""
    random = np.random.default_rng(3)
    hits = 0
    for costs in 1.0 + 0.3 * random.standard_normal((40, 1, 3, 20)):
        (score,) = ranked(bootstrap(costs, interquartile_mean, seed=4))
        hits += score.low <= 1.0 <= score.high
    assert hits >= 32
