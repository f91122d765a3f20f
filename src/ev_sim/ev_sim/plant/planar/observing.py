"""What sensors see of the plant: forces, slips and accelerations at the instant of the state."""

from __future__ import annotations

from math import sqrt

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import DEFLECTION_X, DEFLECTION_Y, VX, VY, WHEEL_SPEED, YAW_RATE, rates, secants
from ev_sim.plant.planar.surroundings import find_road, steer


@compiled
def observe(state: np.ndarray, car, step, road, angle: float, stage: np.ndarray) -> None:
    """Evaluate forces, loads, slips and accelerations at this state and road-wheel angle [rad], into `step`."""
    find_road(state, car, step, road)
    steer(car, step, angle)
    rates(state, stage, car, step, True)
    for i in range(4):
        step.slip_x[i], step.slip_y[i] = slips(state, car, step, i)


@compiled
def slips(state: np.ndarray, car, step, i: int) -> tuple[float, float]:
    """The slips [1] at which the friction curve gives the present forces of wheel i, along and across.

    In steady driving they are the slip ratio and the sine of the slip angle (with the sign of their force); at rest,
    where kinematic slip is 0/0, they stay meaningful and continuous.
    """
    ground_x = state[VX] - car.wheel_y[i] * state[YAW_RATE]
    ground_y = state[VY] + car.wheel_x[i] * state[YAW_RATE]
    cosine, sine = step.cos_steer[i], step.sin_steer[i]
    along = ground_x * cosine + ground_y * sine
    across = ground_y * cosine - ground_x * sine
    rim = car.radius * state[WHEEL_SPEED + i]
    slip_x, slip_y = rim - along, -across
    speed = sqrt(along * along + across * across)
    secant_x, secant_y, transport_x, transport_y = secants(car, step.tyre, slip_x, slip_y, rim, along, speed, i)
    spring_x = car.stiffness_x * state[DEFLECTION_X + i] + car.damping_x * slip_x
    spring_y = car.stiffness_y * state[DEFLECTION_Y + i] + car.damping_y * slip_y
    return (
        spring_x / (step.load[i] * secant_x + transport_x * car.damping_x),
        spring_y / (step.load[i] * secant_y + transport_y * car.damping_y),
    )
