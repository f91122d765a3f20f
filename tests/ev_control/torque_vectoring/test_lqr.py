"""The gains of the regulator against those of a library."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.differentials import DISSERTATION, ZHILEYKIN
from scipy.linalg import solve_discrete_are

from ev_control.torque_vectoring.lqr import SPEED_STEP, SPEEDS, LQRParameters, lqr_gains, lqr_moment
from ev_control.torque_vectoring.single_track import SingleTrackParameters, single_track

P, PERIOD = LQRParameters(), 0.01
# oversteers
TYRES = SingleTrackParameters(front_cornering_stiffness=180e3, rear_cornering_stiffness=120e3)


@pytest.mark.parametrize("car", [DISSERTATION, ZHILEYKIN], ids=lambda car: car.name)
def test_gains_are_those_of_the_riccati_equation(car):
    """Every speed of the schedule, ahead and in reverse.

    Beyond 29 m/s this car is unstable by itself.
    """
    gains = lqr_gains(P, TYRES, car, PERIOD)
    for row in range(2 * SPEEDS):
        speed = SPEED_STEP * (row % SPEEDS) * (1.0 if row < SPEEDS else -1.0)
        model = single_track(TYRES, car, speed)
        rates = np.array([[model.a_11, model.a_12], [model.a_21, model.a_22]])
        a = np.linalg.inv(np.eye(2) - PERIOD * rates)
        b = a @ np.array([[0.0], [PERIOD / car.yaw_inertia]])
        weights = np.diag([1.0 / (0.05 * max(abs(speed), 2.0)) ** 2, 1.0 / 0.05**2])
        effort = np.array([[1.0 / 1500.0**2]])
        cost = solve_discrete_are(a, b, weights, effort)
        wanted = np.linalg.solve(effort + b.T @ cost @ b, b.T @ cost @ a)[0]
        assert (gains.lateral[row], gains.yaw[row]) == pytest.approx(
            tuple(wanted), rel=1e-6, abs=1e-3
        )
        assert np.abs(np.linalg.eigvals(a - b @ wanted[None])).max() < 1.0


def test_gains_between_two_speeds_lie_between_theirs():
    gains = lqr_gains(P, TYRES, DISSERTATION, PERIOD)
    at = [
        lqr_moment(gains, speed, 0.0, 1.0)
        for speed in (-10.0, -11.25, -12.5, 10.0, 11.25, 12.5, 77.5, 500.0)
    ]
    assert at[1] == pytest.approx((at[0] + at[2]) / 2.0, rel=1e-12)
    assert at[4] == pytest.approx((at[3] + at[5]) / 2.0, rel=1e-12)
    assert (at[3], at[6]) == (-gains.yaw[4], at[7])
