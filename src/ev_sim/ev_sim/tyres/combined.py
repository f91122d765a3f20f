"""From slip velocities to the secant stiffness of the two force components: combined slip."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.tyre import Tyre
from ev_sim.tyres.curve import Coefficients, secant

COMBINATIONS = ("slip_vector", "uncoupled")
SLIP_VECTOR, UNCOUPLED = range(len(COMBINATIONS))

# Transport velocity below which slip loses its meaning; far below any motion, it only keeps 0/0 away.
STILL = 1e-9


@inlined
def slip_vector(tyre: Tyre, on_road: Coefficients, slip_x: float, slip_y: float) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when both share one curve over the resulting slip.

    The tyre's `lateral_ratio` [1] stretches the lateral component of the slip vector [1] where the tyre is stiffer or
    softer sideways. Source: Kiencke & Nielsen, Automotive Control Systems, 2nd ed. 2005, wheel model.
    """
    stretched = tyre.lateral_ratio * slip_y
    common = secant(tyre.curve, sqrt(slip_x * slip_x + stretched * stretched), on_road)
    return common, tyre.lateral_ratio * common


@inlined
def uncoupled(tyre: Tyre, on_road: Coefficients, slip_x: float, slip_y: float) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when each direction follows the curve on its own.

    Source: Tatar & Chudzik (their F_p and F_b).
    """
    longitudinal = secant(tyre.curve, abs(slip_x), on_road)
    lateral = secant(tyre.curve, tyre.lateral_ratio * abs(slip_y), on_road)
    return longitudinal, tyre.lateral_ratio * lateral
