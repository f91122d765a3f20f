"""From slip velocities to the secant stiffness of the two force components: combined slip."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.tyre import Tyre
from ev_sim.tyres.curve import Coefficients, secant

COMBINATIONS = ("slip_vector", "uncoupled", "weighted")
SLIP_VECTOR, UNCOUPLED, WEIGHTED = range(len(COMBINATIONS))

# Transport velocity below which slip loses its meaning; far below any motion, it only keeps 0/0 away.
STILL = 1e-9


# How far the slip of the velocities may be ahead of that of the contact [1]: a wheel that starts to turn at rest has a
# slip of 1 at once, while nothing slides yet. An assumption, about the slip of the peak: a contact that sticks comes up
# to the peak of any curve, and driving above walking speed hardly ever meets it.
AHEAD = 0.1


@inlined
def slip_vector(
    tyre: Tyre,
    on_road: Coefficients,
    slip_x: float,
    slip_y: float,
    transport: float,
    contact_x: float,
    contact_y: float,
) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when both share one curve over the resulting slip.

    Slip velocities [m/s] over the transport velocity [m/s] give the slip vector; the tyre's `lateral_ratio` [1]
    stretches its lateral component where it is stiffer or softer sideways. Of the resulting slip counts what is not too
    far `AHEAD` of that of the contact [1]. Source: Kiencke & Nielsen, Automotive Control Systems, 2nd ed. 2005, wheel
    model.
    """
    stretched = tyre.lateral_ratio * slip_y
    slip = sqrt(slip_x * slip_x + stretched * stretched) / transport
    if slip > AHEAD:
        slid_y = tyre.lateral_ratio * contact_y
        slip = min(slip, AHEAD + sqrt(contact_x * contact_x + slid_y * slid_y))
    common = secant(tyre.curve, slip, on_road)
    return common, tyre.lateral_ratio * common


@inlined
def uncoupled(
    tyre: Tyre,
    on_road: Coefficients,
    slip_x: float,
    slip_y: float,
    transport_x: float,
    transport_y: float,
    contact_x: float,
    contact_y: float,
) -> tuple[float, float]:
    """Friction per longitudinal and per lateral slip [1] when each direction follows the curve on its own.

    Slip and transport velocities [m/s] and slips of the contact [1] of the two directions. Source: Tatar & Chudzik
    (their F_p and F_b).
    """
    ratio = tyre.lateral_ratio
    longitudinal = secant(tyre.curve, min(abs(slip_x) / transport_x, AHEAD + abs(contact_x)), on_road)
    lateral = secant(tyre.curve, min(ratio * abs(slip_y) / transport_y, AHEAD + ratio * abs(contact_y)), on_road)
    return longitudinal, ratio * lateral
