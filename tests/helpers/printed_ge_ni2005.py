"""The equations of Ge & Ni (2005) as printed, written down once more for scipy.

v, w and two driven wheels.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from ev_papers.ge_ni2005 import paper

YAW_INERTIA, WHEEL_INERTIA = 450.0, 13.7  # [kg m^2]
SIDES = (-1.0, 1.0, -1.0, 1.0)
_ROUNDS = 4  # of the loop in which the centrifugal force moves the loads and the loads the force


def equal_torques(free: bool = False, rear: float = 0.0) -> OdeSolution:
    """u, v [m/s], w [rad/s] and rear wheel speeds [rad/s] over 3 s from straight running.

    `free`: u follows from the forces instead of being held; `rear`: delta_r [rad].
    """
    spin = paper.SPEED / (1.0 - paper.slip_of(paper.REAR_LOAD)) / paper.RADIUS
    start = [paper.SPEED, 0.0, 0.0, spin, spin]
    options = {
        "method": "LSODA",
        "rtol": 1e-8,
        "atol": 1e-10,
        "max_step": 0.01,
        "dense_output": True,
    }
    return solve_ivp(_rates, (0.0, paper.INSTANT), start, args=(free, rear), **options).sol


def _rates(_: float, y: np.ndarray, free: bool, rear: float) -> list[float]:
    u, v, w, *spin = y
    a, b, track, mass = paper.FRONT_ARM, paper.REAR_ARM, paper.TRACK, paper.MASS
    angle = (paper.STEERING, paper.STEERING, rear, rear)
    across = (v + a * w, v + a * w, v - b * w, v - b * w)
    slip_angle = [ground / u - delta for ground, delta in zip(across, angle, strict=True)]
    stiffness = (paper.FRONT_STIFFNESS / 2,) * 2 + (paper.REAR_STIFFNESS / 2,) * 2
    fy = [-c * alpha for c, alpha in zip(stiffness, slip_angle, strict=True)]
    speed = [
        math.hypot(u + side * track * w / 2, ground) * math.cos(alpha)
        for side, ground, alpha in zip(SIDES, across, slip_angle, strict=True)
    ]
    slip = [
        (w_i * paper.RADIUS - v_i) / (w_i * paper.RADIUS)
        for w_i, v_i in zip(spin, speed[2:], strict=True)
    ]
    centrifugal = mass * math.hypot(u, v) * w
    for _round in range(_ROUNDS):
        moved = a / paper.WHEELBASE * paper.HEIGHT * centrifugal / track
        load = (paper.REAR_LOAD - moved, paper.REAR_LOAD + moved)
        fx = [0.0, 0.0, *(paper.friction(lam) * n for lam, n in zip(slip, load, strict=True))]
        x = [
            along * math.cos(d) - side * math.sin(d)
            for along, side, d in zip(fx, fy, angle, strict=True)
        ]
        y_force = [
            along * math.sin(d) + side * math.cos(d)
            for along, side, d in zip(fx, fy, angle, strict=True)
        ]
        du = sum(x) / mass + v * w if free else 0.0
        dv = sum(y_force) / mass - u * w
        centrifugal = mass * math.hypot(u, v) * (w + (dv * u - v * du) / (u * u + v * v))
    couple = track / 2 * (x[1] + x[3] - x[0] - x[2])
    dw = (a * (y_force[0] + y_force[1]) - b * (y_force[2] + y_force[3]) + couple) / YAW_INERTIA
    return [
        du,
        dv,
        dw,
        *((paper.TORQUE - paper.RADIUS * along) / WHEEL_INERTIA for along in fx[2:]),
    ]
