"""The published values of Shchur (2019) with their bands, as far as more than one scenario compares with them."""

from __future__ import annotations

import math

from ev_sim.report.metric import Reference, within
from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.samples import Parameters

STEADY = 0.005  # band of steady states, as a fraction
OVERSHOOT = 1.0  # band of overshoots [percentage points]
SETTLING = 0.05  # band of settling times, as a fraction
WHEEL_SPEEDS = 0.01  # band of wheel speeds with drives that follow their reference, as a fraction
SWITCHED_ANGLE = math.radians(4.0)  # band of the steering angle with switched drives [rad]

_FOLLOWS = "not printed; follows from {} with the printed parameters"


def ideal(parameters: Parameters) -> bool:
    """Whether the drives of the plant follow their reference without a motor in between."""
    return parameters.get("plant", {}).get("drive", "ideal") == "ideal"


def switched(parameters: Parameters) -> bool:
    """Whether the drives of the plant are switched, so that commutation ripple reaches the steering."""
    return parameters.get("plant", {}).get("drive") == "switched"


def follows(equations: str) -> str:
    """The source of a value that the paper does not print."""
    return _FOLLOWS.format(equations)


def angle_band(angle: float, parameters: Parameters) -> tuple[float, float]:
    """The band of a steady road-wheel angle [rad]."""
    if switched(parameters):
        return within(angle, absolute=SWITCHED_ANGLE)
    return within(angle, relative=STEADY)


def hand_torque_manual() -> Reference:
    """Hand torque that holds 30 deg without the law [N m]."""
    value = paper.hand_torque_manual(paper.TURN_ANGLE)
    return Reference(value, within(value, relative=STEADY), follows("eq. 3 at rest"))


def hand_torque_assisted() -> Reference:
    """Hand torque that holds 30 deg with the law [N m]."""
    value = paper.hand_torque_assisted(paper.TURN_ANGLE)
    return Reference(value, within(value, relative=STEADY), follows("eq. 5 at rest"))


def differential_torque() -> Reference:
    """Differential torque of the law while 30 deg are held [N m]."""
    value = paper.differential_torque(paper.hand_torque_assisted(paper.TURN_ANGLE), paper.TURN_ANGLE)
    return Reference(value, within(value, relative=STEADY), follows("eqs. 4 and 5 at rest"))
