"""Allocation by weighted least squares against daqp, and at the ends of motors and tyres."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.quadratic_programs import by_daqp

from ev_control.torque_vectoring.weighted_least_squares import (
    LEAST_GRIP,
    Demand,
    bounded_least_squares,
)
from ev_msgs_py.contract.wheels import Wheels

ARM = Wheels(-2.5, 2.5, -2.3, 2.3)


def demand(
    total: float, moment: float, grip, least, most, weight: float = 1e4, moment_weight: float = 1.0
) -> Demand:
    """Demand as `least_squares` makes it."""
    whole = (grip[0] + grip[1]) + (grip[2] + grip[3])
    slack = whole * whole / weight
    lever = 2.4 * 2.4 * slack / moment_weight
    return Demand(total, moment, slack, lever, Wheels(*grip), ARM, Wheels(*least), Wheels(*most))


def optimum(d: Demand) -> np.ndarray:
    """Solution by daqp, in shares of the grip: the weights alone make the problem stiff."""
    grip, arm = np.array(d.grip), np.array(d.arm) * np.array(d.grip)
    hessian = np.eye(4) + np.outer(grip, grip) / d.total_slack + np.outer(arm, arm) / d.moment_slack
    slope = -(d.total / d.total_slack * grip + d.moment / d.moment_slack * arm)
    return grip * by_daqp(hessian, slope, np.array(d.least) / grip, np.array(d.most) / grip)


def test_torques_are_those_of_daqp():
    """Torques agree to 1e-3 N m over all allowed weights.

    Every fourth wheel has no range, every second none around zero. The worst of these problems has
    a condition number of 9e9. There daqp is 3.5e-4 N m from the optimum in 60 digits, and ours
    5e-13.
    """
    random = np.random.default_rng(1)
    for _ in range(1000):
        ends = np.sort(random.uniform(-1500.0, 1500.0, (2, 4)), axis=0)
        least, most = np.where(random.random(4) < 0.25, ends[:1], ends)
        weights = 10.0 ** random.uniform((0.0, -3.0), (8.0, 3.0))
        asked = random.uniform((-6000.0, -9000.0), (6000.0, 9000.0))
        d = demand(*asked, random.uniform(1.0, 2500.0, 4), least, most, *weights)
        found = bounded_least_squares(d)
        assert all(low <= u <= high for low, u, high in zip(least, found, most, strict=True))
        assert found == pytest.approx(tuple(optimum(d)), abs=1e-3)


ALIKE, SLIPPERY = [2000.0] * 4, [LEAST_GRIP, 2000.0, LEAST_GRIP, 2000.0]


@pytest.mark.parametrize(
    ("total", "moment", "grip", "most"),
    [
        pytest.param(0.0, 0.0, ALIKE, 300.0, id="nothing is asked for"),
        pytest.param(800.0, 0.0, ALIKE, 300.0, id="no moment"),
        pytest.param(1200.0, 0.0, ALIKE, 300.0, id="exactly what all wheels have"),
        pytest.param(0.0, 2880.0, ALIKE, 300.0, id="exactly the moment that all wheels have"),
        pytest.param(600.0, 1440.0, ALIKE, 300.0, id="exactly what one side has"),
        pytest.param(1e6, -1e6, ALIKE, 300.0, id="a hundred times what there is"),
        pytest.param(800.0, 1000.0, ALIKE, 0.0, id="no wheel has anything"),
        pytest.param(800.0, 1000.0, SLIPPERY, 900.0, id="one side in the air"),
    ],
)
@pytest.mark.parametrize("moment_weight", [1e-3, 1.0, 1e3])
def test_degenerate_demands_get_the_torques_of_daqp(total, moment, grip, most, moment_weight):
    """Equal wheels, none or all of them at their bounds at once.

    To 1e-6 N m: the weight of the demands is 1e4.
    """
    d = demand(total, moment, grip, [-most] * 4, [most] * 4, moment_weight=moment_weight)
    assert bounded_least_squares(d) == pytest.approx(tuple(optimum(d)), abs=1e-6)


def test_without_bounds_both_demands_are_met_with_the_least_use_of_grip():
    """Both are met to 1/weight of all grip.

    On equal wheels a drive torque is shared equally, a moment by the arms.
    """
    d = demand(800.0, 1000.0, [2000.0] * 4, [-1e4] * 4, [1e4] * 4, weight=1e8)
    u = bounded_least_squares(d)
    assert sum(u) == pytest.approx(800.0, abs=1e-3)
    assert np.dot(ARM, u) == pytest.approx(1000.0, abs=1e-3)
    assert (u.front_right - 200.0) / (u.rear_right - 200.0) == pytest.approx(2.5 / 2.3, rel=1e-6)


def test_a_wheel_on_ice_is_given_little_and_the_others_make_up_for_it():
    """Use goes with the square of grip: a tenth of the grip is given a hundredth of the torque."""
    u = bounded_least_squares(
        demand(1000.0, 0.0, [200.0, 200.0, 2000.0, 2000.0], [-1e4] * 4, [1e4] * 4, weight=1e8)
    )
    assert u.front_left / u.rear_left == pytest.approx(0.01, rel=1e-6)
    assert sum(u) == pytest.approx(1000.0, abs=1e-2)


@pytest.mark.parametrize(("moment_weight", "keeps_moment"), [(1e3, True), (1e-3, False)])
def test_where_both_do_not_fit_the_weights_decide(moment_weight, keeps_moment):
    """1000 N m to drive and as much as the same motors of 300 N m could turn with alone.

    2880 N m.
    """
    d = demand(1000.0, 2880.0, [2000.0] * 4, [-300.0] * 4, [300.0] * 4, 1e6, moment_weight)
    u = bounded_least_squares(d)
    missing = (1000.0 - sum(u)) / 1000.0, (2880.0 - np.dot(ARM, u)) / 2880.0
    kept, given_up = missing[::-1] if keeps_moment else missing
    assert kept == pytest.approx(0.0, abs=0.01)
    assert given_up > 0.5


def test_a_mirrored_demand_is_given_mirrored_torques_to_the_bit():
    rng = np.random.default_rng(1)
    for _ in range(200):
        grip, least, most = (
            rng.uniform(1.0, 2000.0, 4),
            -rng.uniform(0.0, 900.0, 4),
            rng.uniform(0.0, 900.0, 4),
        )
        total, moment = rng.uniform(-2000.0, 2000.0), rng.uniform(-3000.0, 3000.0)
        left, right = (
            bounded_least_squares(
                demand(total, side * moment, *(row[order] for row in (grip, least, most)))
            )
            for side, order in ((1.0, [0, 1, 2, 3]), (-1.0, [1, 0, 3, 2]))
        )
        assert left == (right[1], right[0], right[3], right[2])
