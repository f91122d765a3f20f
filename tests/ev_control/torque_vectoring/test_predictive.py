"""The dense bounded program against daqp, and the predictive controller against the regulator."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from helpers.differentials import ZHILEYKIN
from helpers.quadratic_programs import by_daqp

from ev_control.torque_vectoring import predictive
from ev_control.torque_vectoring.active_set import SIZE, Program, solve
from ev_control.torque_vectoring.lqr import Gains, LQRParameters, lqr_gains, lqr_moment
from ev_control.torque_vectoring.single_track import SingleTrackParameters, single_track

P, TYRES, CAR, PERIOD = LQRParameters(), SingleTrackParameters(), ZHILEYKIN, 0.01


def solved(
    hessian: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray, start=None
) -> np.ndarray:
    program = Program(hessian.ravel().tolist(), slope.tolist(), low.tolist(), high.tolist())
    program.x = np.zeros(SIZE).tolist() if start is None else start.tolist()
    solve(program)
    return np.array(program.x)


@pytest.mark.parametrize("condition", [1.0, 1e4, 1e8])
def test_programs_are_solved_as_by_daqp(condition: float):
    """100 random ones from any start; some unknowns have no room at all.

    At 1e8 they differ by 1e-12.
    """
    for hessian, slope, low, high, start in programs(condition):
        assert solved(hessian, slope, low, high, start) == pytest.approx(
            by_daqp(hessian, slope, low, high), abs=1e-10
        )


ONES, TILTED = np.ones(SIZE), np.arange(SIZE) - 4.0  # of the second one a slope is zero
COUPLED = np.eye(SIZE) + np.ones((SIZE, SIZE))
DEGENERATE = {
    "nothing is asked for": (COUPLED, 0.0 * ONES, -ONES, ONES),
    "nothing is asked for, by a bound": (COUPLED, 0.0 * ONES, 0.0 * ONES, ONES),
    "all unknowns gain the same": (COUPLED, -ONES, -0.01 * ONES, 0.01 * ONES),
    "the least lies on every bound": (COUPLED, -(SIZE + 1.0) * ONES, -ONES, ONES),
    "the least lies on some bounds": (np.eye(SIZE), TILTED, -2.0 * ONES, 3.0 * ONES),
    "no unknown has room": (COUPLED, TILTED, 0.5 * ONES, 0.5 * ONES),
    "zero is out of bounds": (COUPLED, TILTED, 0.5 * ONES, 2.0 * ONES),
    "bounds are far away": (COUPLED, TILTED, -100.0 * ONES, 100.0 * ONES),
    "a thousand times what there is": (COUPLED, 1e3 * TILTED, -ONES, ONES),
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_programs_are_solved_as_by_daqp(name: str):
    """Equal to rounding, from within, from either bound and from beyond it.

    No unknown is left where it began.
    """
    hessian, slope, low, high = DEGENERATE[name]
    wanted = by_daqp(hessian, slope, low, high)
    for start in (0.0 * ONES, low, high, low - 1.0, np.where(TILTED > 0.0, low, high)):
        assert solved(hessian, slope, low, high, start) == pytest.approx(
            wanted, rel=1e-12, abs=1e-12
        )


def programs(condition: float):
    """Random ones: matrix, slope, bounds, and where to start."""
    random = np.random.default_rng(1)
    for _ in range(100):
        turned = np.linalg.qr(random.standard_normal((SIZE, SIZE)))[0]
        hessian = (turned * condition ** random.uniform(0.0, 1.0, SIZE)) @ turned.T
        low = -random.uniform(0.0, 1.0, SIZE)
        high = np.where(random.random(SIZE) < 0.1, low, random.uniform(0.0, 1.0, SIZE))
        yield (
            hessian,
            3.0 * condition**0.5 * random.standard_normal(SIZE),
            low,
            high,
            random.uniform(-2.0, 2.0, SIZE),
        )


@functools.cache
def gains() -> Gains:
    return lqr_gains(P, TYRES, CAR, PERIOD)


def moment(lateral: float, yaw: float, ahead: float, most: float, speed: float = 20.0) -> float:
    model = single_track(TYRES, CAR, speed)
    motion = predictive.motion_over(P, CAR, model, PERIOD)
    aside = P.sideslip_error * max(abs(speed), TYRES.slowest)
    errors, bounds = predictive.Errors(speed, lateral, yaw), predictive.Bounds(ahead, most)
    return predictive.predictive_moment(P, gains(), motion, aside, errors, bounds)


@pytest.mark.parametrize("speed", [5.0, 20.0, -10.0])
def test_within_its_bounds_it_is_the_regulator(speed: float):
    """The cost behind the horizon is that of the endless one.

    At speeds of the schedule nothing is interpolated.
    """
    for lateral, yaw in ((0.1, 0.0), (0.0, 0.05), (-0.2, 0.1)):
        wanted = lqr_moment(gains(), speed, lateral, yaw)
        assert moment(lateral, yaw, 500.0, 1e6, speed) == pytest.approx(wanted, rel=1e-8)


def test_at_its_bound_it_stays_there_with_what_is_fed_ahead():
    """1000 N m at most, of which 300 N m are fed ahead.

    700 N m are left to the left, -1300 N m to the right.
    """
    assert moment(0.0, -0.5, 300.0, 1000.0) == pytest.approx(700.0, rel=1e-12)
    assert moment(0.0, 0.5, 300.0, 1000.0) == pytest.approx(-1300.0, rel=1e-12)


def test_the_programs_of_the_law_are_solved_as_by_daqp(monkeypatch):
    """Errors and bounds are as on the road, absent, or without a zero within.

    To 1e-6 N m; the unit of the program is 1500 N m, and daqp's tolerance 1e-12 of it.
    """
    solved_ones = []

    def recorded(w: Program) -> None:
        lower = np.tril(np.array(w.hessian).reshape(SIZE, SIZE))
        hessian = lower + np.tril(lower, -1).T
        solved_ones.append(
            by_daqp(hessian, *(np.array(each) for each in (w.slope, w.low, w.high)))[0]
        )
        solve(w)

    monkeypatch.setattr(predictive, "solve", recorded)
    random = np.random.default_rng(1)
    for n in range(60):
        lateral, yaw = (0.0, 0.0) if n % 10 == 0 else random.normal(0.0, (1.0, 0.3)).tolist()
        most = 0.0 if n % 10 == 1 else random.uniform(0.0, 3000.0)
        ahead, speed = random.normal(0.0, 2000.0), random.uniform(-15.0, 45.0)
        found = moment(lateral, yaw, ahead, most, speed)
        assert -most - 1e-9 <= found + ahead <= most + 1e-9
        assert found == pytest.approx(P.moment * solved_ones[-1], abs=1e-6)
    assert len(solved_ones) == 60
