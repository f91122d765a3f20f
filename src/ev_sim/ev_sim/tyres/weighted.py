"""Combined slip by the weighting functions of the Magic Formula, as secants over the slip of the contact."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.mf_tyre import MfTyre
from ev_sim.tyres.combined import AHEAD
from ev_sim.tyres.curve import SLIP_FLOOR
from ev_sim.tyres.mf_tyre import at_load, forces

# The least speed along the wheel over the transport velocity [1]: a wheel that spins on the spot or slides sideways has
# a slip ratio or a tangent of 50, where the formula has long come to its end.
LEAST_ROLLING = 0.02


@inlined
def weighted(
    tyre: MfTyre,
    on_road: Any,
    load: float,
    slip_x: float,
    slip_y: float,
    along: float,
    transport: float,
    contact_x: float,
    contact_y: float,
) -> tuple[float, float, float, float]:
    """Force over slip along and across [N], and the peaks of both forces [N].

    Slip velocities [m/s] over the transport velocity [m/s] give slips; those of the formula are over the speed `along`
    the wheel [m/s]. As with one curve, of the resulting slip counts what is not too far `AHEAD` of that of the contact
    [1]. `on_road` holds what surface and air pressure leave of friction (c0) and slip stiffness (c1).
    """
    size_x, size_y = abs(slip_x) / transport, abs(slip_y) / transport
    slip = sqrt(size_x * size_x + size_y * size_y)
    rolling = min(abs(along) / transport, 1.0)
    if slip > AHEAD:
        counted = min(slip, AHEAD + sqrt(contact_x * contact_x + contact_y * contact_y)) / slip
        size_x *= counted
        size_y *= counted
        rolling = 1.0 - counted * (1.0 - rolling)
    rolling = max(rolling, LEAST_ROLLING)
    slip_ratio, tangent = max(size_x / rolling, SLIP_FLOOR), max(size_y / rolling, SLIP_FLOOR)
    drives = slip_x * along >= 0.0
    loaded = at_load(tyre, load, on_road.c0, on_road.c1)
    force_x, force_y = forces(tyre, loaded, slip_ratio, tangent, drives)
    return (
        max(force_x, 0.0) / (slip_ratio * rolling),
        max(force_y, 0.0) / (tangent * rolling),
        loaded.peak_x,
        loaded.peak_y,
    )
