"""Numbers that follow from the equations of Ge & Ni (2005) with their parameters.

Ge Yinghui, Ni Guangzheng, "A novel electronic differential algorithm for in-wheel motor driven EV"
(in Chinese), Automotive Engineering 27 (2005) 3. The parameters are written down here once more
instead of being taken from the run, so that a run with other parameters is judged against the paper
all the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ev_core.vehicle.car import GRAVITY

MASS = 2500.0  # m [kg]
WHEELBASE = 1.72  # L [m]
FRONT_ARM = 0.9  # a [m]
REAR_ARM = 0.82  # b [m]
TRACK = 1.12  # B [m]
HEIGHT = 0.6  # h [m]
RADIUS = 0.32  # R [m]
FRONT_STIFFNESS = 2 * 10500.0  # of the axle, C_1 + C_2 [N/rad]
REAR_STIFFNESS = 2 * 12000.0  # C_3 + C_4 [N/rad]
PEAK, PEAK_SLIP = 0.8, 0.2  # mu_p, lambda_p of the dry road [1]
SPEED = 5.0  # u, held [m/s]
STEERING = math.radians(2.0)  # delta [rad]
TORQUE = 1200.0  # T* of each driven wheel [N m]
TARGET = 0.19  # lambda_3* [1]
YAW_GAIN = 0.11  # K_1 [s/rad], print damaged
INSTANT = 3.0  # end of figs 3 and 4 [s]
REAR_LOAD = MASS * GRAVITY * FRONT_ARM / WHEELBASE / 2  # of each rear wheel at rest [N]

Slip = TypeVar("Slip", float, np.ndarray)


@dataclass(frozen=True, slots=True)
class SteadyTurn:
    """The motion of the centre of mass on a circle."""

    yaw_rate: float  # [rad/s]
    sideslip: float  # beta [rad]
    lateral_speed: float  # v [m/s]
    radius: float  # rho = V/(w + beta') [m]
    centripetal_acceleration: float  # V (w + beta') [m/s^2]


def steady_turn(rear_steering: float = 0.0) -> SteadyTurn:
    """Motion in which eqs 1 and 2 come to rest: equal torques (X_3 = X_4), angles small, u held.

    Force and moment balance give w = (delta_f - delta_r') u/(L + K u^2) with
    K = m (b/C_f - a/C_r)/L, and the slip angle of the rear axle
    v = b w + delta_r' u - m a u^2 w/(C_r L). Turned rear wheels [rad] push sideways by F_x delta_r
    as well, as if they were turned by delta_r' = delta_r (1 + F_x/C_r) (eq 3).
    """
    gradient = MASS * (REAR_ARM / FRONT_STIFFNESS - FRONT_ARM / REAR_STIFFNESS) / WHEELBASE
    rear = rear_steering * (1.0 + 2.0 * TORQUE / RADIUS / REAR_STIFFNESS)
    yaw_rate = (STEERING - rear) * SPEED / (WHEELBASE + gradient * SPEED**2)
    slipping = MASS * FRONT_ARM * SPEED**2 * yaw_rate / (REAR_STIFFNESS * WHEELBASE)
    lateral = REAR_ARM * yaw_rate + rear * SPEED - slipping
    speed = math.hypot(SPEED, lateral)
    return SteadyTurn(
        yaw_rate=yaw_rate,
        sideslip=math.atan2(lateral, SPEED),
        lateral_speed=lateral,
        radius=speed / yaw_rate,
        centripetal_acceleration=speed * yaw_rate,
    )


def rear_loads() -> tuple[float, float]:
    """N_3 and N_4 of the steady turn, a/(2L) (m g -+ 2 h F_c/B) with F_c = m V w [N]."""
    acceleration = steady_turn().centripetal_acceleration
    moved = FRONT_ARM / WHEELBASE * HEIGHT * MASS * acceleration / TRACK
    return REAR_LOAD - moved, REAR_LOAD + moved


def rear_speeds() -> tuple[float, float]:
    """V_3 and V_4 of the steady turn, of the wheel centres along the wheels, u -+ B w/2 [m/s]."""
    side = TRACK * steady_turn().yaw_rate / 2
    return SPEED - side, SPEED + side


def friction(slip: Slip) -> Slip:
    """Printed fit of the friction to a slip or to samples (n,), 2 mu_p l_p l/(l^2 + l_p^2) [1]."""
    return 2 * PEAK * PEAK_SLIP * slip / (slip**2 + PEAK_SLIP**2)


def slip_of(load: float, torque: float = TORQUE) -> float:
    """Slip below the peak at which a wheel with a load [N] takes a torque [N m] steadily [1]."""
    # The smaller root of the printed fit; the larger one lies beyond the peak.
    use = torque / (RADIUS * load)
    return PEAK_SLIP * (PEAK - math.sqrt(PEAK**2 - use**2)) / use
