"""One step of the classical Runge-Kutta method, with set-valued dry friction at the wheels."""

from __future__ import annotations

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import WHEEL_SPEED, rates
from ev_sim.plant.planar.state import INTEGRATED_SIZE


@compiled
def integrate(state: np.ndarray, car, step, h: float, stage: np.ndarray, slopes: np.ndarray) -> None:
    """Advance the integrated part of the state in place by h [s].

    `stage` of shape (INTEGRATED_SIZE,) and `slopes` of shape (4, INTEGRATED_SIZE) are working memory. A wheel that
    dry friction has stopped within the step ends it at rest, exactly.
    """
    k1, k2, k3, k4 = slopes[0], slopes[1], slopes[2], slopes[3]
    rates(state, k1, car, step, True)
    for n in range(INTEGRATED_SIZE):
        stage[n] = state[n] + 0.5 * h * k1[n]
    rates(stage, k2, car, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = state[n] + 0.5 * h * k2[n]
    rates(stage, k3, car, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = state[n] + h * k3[n]
    rates(stage, k4, car, step, False)
    for n in range(INTEGRATED_SIZE):
        state[n] += h / 6.0 * ((k1[n] + k4[n]) + 2.0 * (k2[n] + k3[n]))
    for i in range(4):
        if step.motion[i] * state[WHEEL_SPEED + i] < 0.0:
            state[WHEEL_SPEED + i] = 0.0
