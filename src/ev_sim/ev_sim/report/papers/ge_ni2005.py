"""What follows from the equations of Ge & Ni (2005) with their parameters.

Ge Yinghui, Ni Guangzheng, "A novel electronic differential algorithm for in-wheel motor driven EV" (in Chinese),
Automotive Engineering 27 (2005) 3. The parameters are written down here once more instead of being taken from the run,
so that a run with other parameters is judged against the paper all the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MASS = 2500.0  # m [kg]
WHEELBASE = 1.72  # L [m]
FRONT_ARM = 0.9  # a [m]
REAR_ARM = 0.82  # b [m]
FRONT_STIFFNESS = 2 * 10500.0  # of the axle, C_1 + C_2 [N/rad]
REAR_STIFFNESS = 2 * 12000.0  # C_3 + C_4 [N/rad]
SPEED = 5.0  # u, held [m/s]
STEERING = math.radians(2.0)  # delta [rad]
INSTANT = 3.0  # end of figs 3 and 4 [s]


@dataclass(frozen=True, slots=True)
class SteadyTurn:
    """The motion of the centre of mass on a circle."""

    yaw_rate: float  # [rad/s]
    sideslip: float  # beta [rad]
    radius: float  # rho = V/(w + beta') [m]
    centripetal_acceleration: float  # V (w + beta') [m/s^2]


def steady_turn() -> SteadyTurn:
    """Where eqs 1 and 2 come to rest with equal torques (X_3 = X_4), angles small, u held.

    Force and moment balance give w = delta u/(L + K u^2) with K = m (b/C_f - a/C_r)/L, and the slip angle of the rear
    axle v = b w - m a u^2 w/(C_r L).
    """
    gradient = MASS * (REAR_ARM / FRONT_STIFFNESS - FRONT_ARM / REAR_STIFFNESS) / WHEELBASE
    yaw_rate = STEERING * SPEED / (WHEELBASE + gradient * SPEED**2)
    lateral = REAR_ARM * yaw_rate - MASS * FRONT_ARM * SPEED**2 * yaw_rate / (REAR_STIFFNESS * WHEELBASE)
    speed = math.hypot(SPEED, lateral)
    return SteadyTurn(yaw_rate, math.atan2(lateral, SPEED), speed / yaw_rate, speed * yaw_rate)
