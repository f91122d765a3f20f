"""The dense program with bounds against a library, and the predictive controller against the regulator."""

from __future__ import annotations

import numpy as np
import pytest
from differentials import ZHILEYKIN
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from ev_control.torque_vectoring.active_set import SIZE, Program, solve
from ev_control.torque_vectoring.lqr import LQRParameters, lqr_gains, lqr_moment
from ev_control.torque_vectoring.predictive import predictive_moment
from ev_control.torque_vectoring.single_track import SingleTrackParameters, single_track

P, TYRES, CAR, PERIOD = LQRParameters(), SingleTrackParameters(), ZHILEYKIN, 0.01


def solved(hessian: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray, start=None) -> np.ndarray:
    program = Program(hessian.ravel().tolist(), slope.tolist(), low.tolist(), high.tolist())
    program.x = np.zeros(SIZE).tolist() if start is None else start.tolist()
    solve(program)
    return np.array(program.x)


def test_programs_are_solved_as_by_a_library():
    """100 random ones from any start; some unknowns have no room at all. As least squares by H = L L'."""
    for hessian, slope, low, high, start in programs(1.0):
        factor = np.linalg.cholesky(hessian)
        right = -solve_triangular(factor, slope, lower=True)
        by_library = lsq_linear(factor.T, right, (low - 1e-12, high + 1e-12), method="bvls", tol=1e-14).x
        assert solved(hessian, slope, low, high, start) == pytest.approx(by_library, abs=1e-7)


def test_badly_conditioned_programs_are_solved_to_their_optimum():
    """No gradient where an unknown is free, and one out of the program at a bound (Karush, Kuhn, Tucker).

    At a condition number of 1e4 the library's method stops early in one of 25 of them, at a larger cost.
    """
    for hessian, slope, low, high, start in programs(1e4):
        x = solved(hessian, slope, low, high, start)
        gradient, close = hessian @ x + slope, 1e-8 * np.abs(slope).max()
        assert ((x >= low) & (x <= high)).all()
        assert (np.abs(gradient[(x > low) & (x < high)]) < close).all()
        assert (gradient[(x == low) & (x < high)] > -close).all()
        assert (gradient[(x == high) & (x > low)] < close).all()


def programs(condition: float):
    """Random ones: matrix, slope, bounds, and where to start."""
    random = np.random.default_rng(1)
    for _ in range(100):
        turned = np.linalg.qr(random.standard_normal((SIZE, SIZE)))[0]
        hessian = (turned * condition ** random.uniform(0.0, 1.0, SIZE)) @ turned.T
        low = -random.uniform(0.0, 1.0, SIZE)
        high = np.where(random.random(SIZE) < 0.1, low, random.uniform(0.0, 1.0, SIZE))
        yield hessian, 3.0 * condition**0.5 * random.standard_normal(SIZE), low, high, random.uniform(-2.0, 2.0, SIZE)


def test_without_bounds_it_is_newtons_step():
    hessian, slope = np.diag(np.arange(1.0, SIZE + 1.0)), np.ones(SIZE)
    far = np.full(SIZE, 1e6)
    assert solved(hessian, slope, -far, far) == pytest.approx(-1.0 / np.arange(1.0, SIZE + 1.0), rel=1e-12)


def moment(lateral: float, yaw: float, ahead: float, most: float, speed: float = 20.0) -> float:
    gains = lqr_gains(P, TYRES, CAR, PERIOD)
    model = single_track(TYRES, CAR, speed)
    return predictive_moment(P, CAR, gains, model, PERIOD, speed, TYRES.slowest, lateral, yaw, ahead, most)


@pytest.mark.parametrize("speed", [5.0, 20.0, -10.0])
def test_within_its_bounds_it_is_the_regulator(speed: float):
    """The cost behind the horizon is that of the endless one; at speeds of the schedule nothing is interpolated."""
    gains = lqr_gains(P, TYRES, CAR, PERIOD)
    for lateral, yaw in ((0.1, 0.0), (0.0, 0.05), (-0.2, 0.1)):
        wanted = lqr_moment(gains, speed, lateral, yaw)
        assert moment(lateral, yaw, 500.0, 1e6, speed) == pytest.approx(wanted, rel=1e-8)


def test_at_its_bound_it_stays_there_with_what_is_fed_ahead():
    """1000 N m at most, of which 300 N m are fed ahead: 700 N m are left to the left, -1300 N m to the right."""
    assert moment(0.0, -0.5, 300.0, 1000.0) == pytest.approx(700.0, rel=1e-12)
    assert moment(0.0, 0.5, 300.0, 1000.0) == pytest.approx(-1300.0, rel=1e-12)
