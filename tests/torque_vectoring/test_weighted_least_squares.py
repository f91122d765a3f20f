"""The allocation by weighted least squares against a library, and what it does where motors or tyres end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from ev_control.torque_vectoring.weighted_least_squares import Demand, bounded_least_squares
from ev_msgs_py.contract.wheels import Wheels

ARM = Wheels(-2.5, 2.5, -2.3, 2.3)


def demand(total: float, moment: float, grip, least, most, weight: float = 1e4, moment_weight: float = 1.0) -> Demand:
    """As `least_squares` makes it."""
    whole = (grip[0] + grip[1]) + (grip[2] + grip[3])
    slack = whole * whole / weight
    lever = 2.4 * 2.4 * slack / moment_weight
    return Demand(total, moment, slack, lever, Wheels(*grip), ARM, Wheels(*least), Wheels(*most))


def by_library(d: Demand) -> np.ndarray:
    rows = np.vstack(
        [np.diag(1.0 / np.array(d.grip)), np.ones(4) / np.sqrt(d.total_slack), np.array(ARM) / np.sqrt(d.moment_slack)]
    )
    right = np.r_[np.zeros(4), d.total / np.sqrt(d.total_slack), d.moment / np.sqrt(d.moment_slack)]
    return lsq_linear(rows, right, (np.array(d.least), np.array(d.most)), method="bvls", tol=1e-14).x


four = st.tuples(*[st.floats(0.0, 1.0)] * 4)


@given(
    total=st.floats(-6000.0, 6000.0),
    moment=st.floats(-9000.0, 9000.0),
    grip=st.tuples(*[st.floats(1.0, 2500.0)] * 4),
    down=four,
    up=four,
    weight=st.floats(0.0, 6.0),
    moment_weight=st.floats(-2.0, 2.0),
)
def test_torques_are_those_of_a_library(total, moment, grip, down, up, weight, moment_weight):
    """To 1e-3 N m: at the largest weight the problem's condition number is 1e6 and the library's bounds are inexact."""
    least = [-1500.0 * share - 1e-6 for share in down]
    most = [1500.0 * share + 1e-6 for share in up]
    d = demand(total, moment, grip, least, most, 10.0**weight, 10.0**moment_weight)
    found = bounded_least_squares(d)
    assert all(low <= u <= high for low, u, high in zip(least, found, most, strict=True))
    assert found == pytest.approx(tuple(by_library(d)), abs=1e-3)


def test_without_bounds_both_demands_are_met_with_the_least_use_of_grip():
    """To 1/weight of all grip. On equal wheels a drive torque is shared equally, a moment by the arms."""
    d = demand(800.0, 1000.0, [2000.0] * 4, [-1e4] * 4, [1e4] * 4, weight=1e8)
    u = bounded_least_squares(d)
    assert sum(u) == pytest.approx(800.0, abs=1e-3)
    assert np.dot(ARM, u) == pytest.approx(1000.0, abs=1e-3)
    assert (u.front_right - 200.0) / (u.rear_right - 200.0) == pytest.approx(2.5 / 2.3, rel=1e-6)


def test_a_wheel_on_ice_is_given_little_and_the_others_make_up_for_it():
    """Use goes with the square of grip: a tenth of the grip is given a hundredth of the torque."""
    u = bounded_least_squares(demand(1000.0, 0.0, [200.0, 200.0, 2000.0, 2000.0], [-1e4] * 4, [1e4] * 4, weight=1e8))
    assert u.front_left / u.rear_left == pytest.approx(0.01, rel=1e-6)
    assert sum(u) == pytest.approx(1000.0, abs=1e-2)


@pytest.mark.parametrize(("moment_weight", "keeps_moment"), [(1e3, True), (1e-3, False)])
def test_where_both_do_not_fit_the_weights_decide(moment_weight, keeps_moment):
    """1000 N m to drive and as much as the same motors of 300 N m could turn with alone: 2880 N m."""
    d = demand(1000.0, 2880.0, [2000.0] * 4, [-300.0] * 4, [300.0] * 4, 1e6, moment_weight)
    u = bounded_least_squares(d)
    missing = (1000.0 - sum(u)) / 1000.0, (2880.0 - np.dot(ARM, u)) / 2880.0
    kept, given_up = missing[::-1] if keeps_moment else missing
    assert kept == pytest.approx(0.0, abs=0.01)
    assert given_up > 0.5


def test_a_mirrored_demand_is_given_mirrored_torques_to_the_bit():
    rng = np.random.default_rng(1)
    for _ in range(200):
        grip, least, most = rng.uniform(1.0, 2000.0, 4), -rng.uniform(0.0, 900.0, 4), rng.uniform(0.0, 900.0, 4)
        total, moment = rng.uniform(-2000.0, 2000.0), rng.uniform(-3000.0, 3000.0)
        left, right = (
            bounded_least_squares(demand(total, side * moment, *(row[order] for row in (grip, least, most))))
            for side, order in ((1.0, [0, 1, 2, 3]), (-1.0, [1, 0, 3, 2]))
        )
        assert left == (right[1], right[0], right[3], right[2])
