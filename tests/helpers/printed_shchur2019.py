"""Results of the equations of Shchur (2019) with the printed parameters, as in published.csv."""

from __future__ import annotations

from scipy.optimize import minimize_scalar

from documentation.closed_form import peak_time
from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.paper import CLOSED_LOOP


def lowest_differential_torque() -> tuple[float, float]:
    """Time [s] and size [N m] of fig 1b's lowest differential torque (eqs 4 and 7)."""
    steady = CLOSED_LOOP.steady_angle(
        (1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP
    )

    def torque(time: float) -> float:
        angle, rate = steady * (1 + CLOSED_LOOP.deviation(time)), steady * CLOSED_LOOP.rate(time)
        return paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, angle, rate)

    found = minimize_scalar(
        torque, bounds=(0.0, peak_time(CLOSED_LOOP)), method="bounded", options={"xatol": 1e-9}
    )
    return float(found.x), float(found.fun)


def hand_torque_manual(road_wheel_angle: float) -> float:
    """Hand torque that holds a road-wheel angle without the law (eq. 3 at rest) [N m]."""
    return paper.K_P * road_wheel_angle / paper.I_RATIO
