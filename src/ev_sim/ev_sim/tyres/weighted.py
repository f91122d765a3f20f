"""Combined slip by the weighting functions of the Magic Formula, as secants over the slip of the contact."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.mf_tyre import MfTyres
from ev_sim.tyres.combined import AHEAD
from ev_sim.tyres.curve import SLIP_FLOOR
from ev_sim.tyres.mf_tyre import AtLoad, forces

# The least speed along the wheel over the transport velocity [1]: a wheel that spins on the spot or slides sideways has
# a slip ratio or a tangent of 50, where the formula has long come to its end.
LEAST_ROLLING = 0.02


@inlined
def weighted(
    tyres: MfTyres,
    i: int,
    loaded: AtLoad,
    slip_x: float,
    slip_y: float,
    along: float,
    transport: float,
    contact_x: float,
    contact_y: float,
    plain: bool,
) -> tuple[float, float]:
    """Force over slip along and across wheel i [N], of its tyre at its load.

    Slip velocities [m/s] over the transport velocity [m/s] give slips; those of the formula are over the speed `along`
    the wheel [m/s]. As with one curve, of the resulting slip counts what is not too far `AHEAD` of that of the contact
    [1]. `plain` is what `is_plain` says of the tyres.
    """
    slid = max(sqrt(slip_x * slip_x + slip_y * slip_y), AHEAD * transport)
    counted = min(slid, (AHEAD + sqrt(contact_x * contact_x + contact_y * contact_y)) * transport)
    # What counts of the slip velocities, over what is left of the speed along the wheel, both times `slid`.
    full = slid * transport
    rolling = max(full - counted * (transport - min(abs(along), transport)), LEAST_ROLLING * full)
    scale = counted / rolling
    slip_ratio, tangent = max(abs(slip_x) * scale, SLIP_FLOOR), max(abs(slip_y) * scale, SLIP_FLOOR)
    direction = 1.0 if slip_x * along >= 0.0 else -1.0
    force_x, force_y = forces(tyres, i, loaded, slip_ratio, tangent, direction, plain)
    secant = full / (rolling * slip_ratio * tangent)
    return max(force_x, 0.0) * (secant * tangent), max(force_y, 0.0) * (secant * slip_ratio)
