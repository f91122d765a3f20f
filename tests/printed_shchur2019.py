"""What follows from the equations of Shchur (2019) with the printed parameters, and is written in published.csv."""

from __future__ import annotations

import math

from scipy.optimize import brentq, minimize_scalar

from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.paper import CLOSED_LOOP, SecondOrder


def extreme(system: SecondOrder, number: int) -> float:
    """Size of the n-th extreme of the deviation as a fraction of the final value; the 0th is the step itself."""
    return math.exp(-system.decay * number * math.pi / system.damped_frequency)


def overshoot(system: SecondOrder) -> float:
    """First peak beyond the steady angle [% of it]."""
    return 100 * extreme(system, 1)


def peak_time(system: SecondOrder) -> float:
    """Time from the step to the first peak, half of the period [s]."""
    return math.pi / system.damped_frequency


def settling_time(system: SecondOrder, band: float) -> float:
    """Time from the step to the last entry into +-band around the final value [s]."""
    swing = next(n for n in range(1000) if extreme(system, n + 1) <= band)
    # The deviation falls monotonically from this extreme, the last outside the band, to the next one.
    outside, inside = swing * peak_time(system), (swing + 1) * peak_time(system)
    edge = math.copysign(band, system.deviation(outside))
    return float(brentq(lambda time: system.deviation(time) - edge, outside, inside, xtol=1e-12))


def lowest_differential_torque() -> tuple[float, float]:
    """When after the step [s] the differential torque of fig. 1b is lowest, and how low [N m] (eqs 4 and 7)."""
    steady = CLOSED_LOOP.steady_angle((1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP)

    def torque(time: float) -> float:
        angle, rate = steady * (1 + CLOSED_LOOP.deviation(time)), steady * CLOSED_LOOP.rate(time)
        return paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, angle, rate)

    found = minimize_scalar(torque, bounds=(0.0, peak_time(CLOSED_LOOP)), method="bounded", options={"xatol": 1e-9})
    return float(found.x), float(found.fun)


def hand_torque_manual(road_wheel_angle: float) -> float:
    """Hand torque that holds a road-wheel angle without the law (eq. 3 at rest) [N m]."""
    return paper.K_P * road_wheel_angle / paper.I_RATIO
