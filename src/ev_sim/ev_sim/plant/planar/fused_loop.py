"""The fused loop: many steps of the whole plant, and what is seen of it then, in one compiled call."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import HEADING, VX, VY, WHEEL_ANGLE
from ev_sim.plant.planar.integrator import integrate
from ev_sim.plant.planar.observing import observe
from ev_sim.plant.planar.powertrain import account, apply_drives
from ev_sim.plant.planar.showing import show
from ev_sim.plant.planar.state import INTEGRATED_SIZE, X, Y
from ev_sim.plant.planar.surroundings import find_road, steer

MEMORY = 5 * INTEGRATED_SIZE + 20  # working memory of the Runge-Kutta method and of the drives


@compiled
def run(
    state: np.ndarray,
    record: np.ndarray,
    steps: int,
    memory: np.ndarray,
    row: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    slope: np.ndarray,
    voltages: np.ndarray,
    maps,
) -> int:
    """Advance the plant in place by a number of steps under the command in `record`, and observe it.

    The steering angle goes on at its commanded rate, the torque commands are held. `record` is a PLANT of shape (1,);
    the arrays of the road come one by one, because a tuple of them costs more for each call. `maps` are the three
    arrays of an efficiency map, or None: then this is compiled without looking at any. `memory` of shape (MEMORY,) is
    working memory; the signals of the last instant go into `row` (see showing.py). Without steps the plant is observed
    only. Returns how many wheels are off the ground.
    """
    plant = record[0]
    car, step, h = plant.car, plant.step, plant.h
    lags = (plant.lags[0], plant.lags[1], plant.lags[2], plant.lags[3])
    brushless = (plant.drives, plant.drive_parameters)
    road = (left, right, slope)
    stage = memory[:INTEGRATED_SIZE]
    slopes = memory[INTEGRATED_SIZE : 5 * INTEGRATED_SIZE].reshape(4, INTEGRATED_SIZE)
    work = memory[5 * INTEGRATED_SIZE :].reshape(5, 4)
    turned = work[4]
    if steps > 0:
        for i in range(4):
            step.mean_drive[i] = 0.0
    for n in range(steps):
        find_road(state, car, step, road)
        steer(car, step, step.steering_angle + step.steering_rate * ((n + 0.5) * h))
        apply_drives(state, car, step, maps, voltages, lags, brushless, h, work)
        vx, vy, heading = state[VX], state[VY], state[HEADING]
        for i in range(4):
            turned[i] = -state[WHEEL_ANGLE + i]
        integrate(state, car, step, h, stage, slopes)
        for i in range(4):
            turned[i] += state[WHEEL_ANGLE + i]
            step.mean_drive[i] += step.drive[i] / steps
        # The position feeds nothing back, so the trapezoidal rule over the step is enough.
        mean_x, mean_y = 0.5 * (vx + state[VX]), 0.5 * (vy + state[VY])
        middle = 0.5 * (heading + state[HEADING])
        cosine, sine = cos(middle), sin(middle)
        state[X] += h * (mean_x * cosine - mean_y * sine)
        state[Y] += h * (mean_y * cosine + mean_x * sine)
        account(state, car, step, maps, voltages, brushless, turned, h, work)
    observe(state, car, step, road, step.steering_angle + step.steering_rate * (steps * h), stage)
    show(state, car, step, voltages, work[0], row)
    lifted = 0
    for i in range(4):
        lifted += int(step.load[i] == 0.0)
    return lifted
