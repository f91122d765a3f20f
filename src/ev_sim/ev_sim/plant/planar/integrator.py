"""One step of the classical Runge-Kutta method, with set-valued dry friction at the wheels."""

from __future__ import annotations

from collections.abc import MutableSequence

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.body import rates
from ev_sim.plant.planar.constants import BodyConstants
from ev_sim.plant.planar.memory import Stages, Step
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.state import INTEGRATED_SIZE, WHEEL_SPEED


@inlined
def integrate(
    y: MutableSequence[float],
    p: PlanarParameters,
    car: Car,
    body: BodyConstants,
    step: Step,
    stages: Stages,
    h: float,
) -> None:
    """Advance the integrated part of the state in place by h [s].

    A wheel that dry friction has stopped within the step ends it at rest, exactly.
    """
    stage, k1, k2, k3, k4 = stages.state, stages.k1, stages.k2, stages.k3, stages.k4
    rates(y, k1, p, car, body, step, True)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k1[n]
    rates(stage, k2, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k2[n]
    rates(stage, k3, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + h * k3[n]
    rates(stage, k4, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        y[n] += h / 6.0 * ((k1[n] + k4[n]) + 2.0 * (k2[n] + k3[n]))
    for i in range(4):
        if step.motion[i] * y[WHEEL_SPEED + i] < 0.0:
            y[WHEEL_SPEED + i] = 0.0
