"""From slip velocities to the secant stiffness of the two force components: combined slip."""

from __future__ import annotations

from math import sqrt

from ev_sim.compiled import compiled
from ev_sim.tyres.curve import secant

COMBINATIONS = ("slip_vector", "uncoupled")

# Transport velocity below which slip loses its meaning; far below any motion, it only keeps 0/0 away.
STILL = 1e-9


@compiled
def slip_vector(
    curve: int,
    slip_x: float,
    slip_y: float,
    transport: float,
    lateral_ratio: float,
    c0: float,
    c1: float,
    c2: float,
    c3: float,
) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when both share one curve over the resulting slip.

    Slip velocities [m/s] over the transport velocity [m/s] give the slip vector; `lateral_ratio` [1] stretches its
    lateral component where the tyre is stiffer or softer sideways. Source: Kiencke & Nielsen, Automotive Control
    Systems, 2nd ed. 2005, wheel model.
    """
    stretched = lateral_ratio * slip_y
    common = secant(curve, sqrt(slip_x * slip_x + stretched * stretched) / transport, c0, c1, c2, c3)
    return common, lateral_ratio * common


@compiled
def uncoupled(
    curve: int,
    slip_x: float,
    slip_y: float,
    transport_x: float,
    transport_y: float,
    lateral_ratio: float,
    c0: float,
    c1: float,
    c2: float,
    c3: float,
) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when each direction follows the curve on its own.

    Slip and transport velocities [m/s] of the two directions. Source: Tatar & Chudzik (their F_p and F_b).
    """
    longitudinal = secant(curve, abs(slip_x) / transport_x, c0, c1, c2, c3)
    lateral = secant(curve, lateral_ratio * abs(slip_y) / transport_y, c0, c1, c2, c3)
    return longitudinal, lateral_ratio * lateral
