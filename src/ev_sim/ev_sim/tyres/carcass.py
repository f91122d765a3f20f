"""The carcass, in series with the sliding contact; and the load that tyres with one curve do not carry in full."""

from __future__ import annotations

from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.compilable import inlined


@inlined
def sensitivity(tyre: Tyre, load: float) -> float:
    """Share [1] of friction and slip stiffness over load that is left at a load [N].

    1 - e (N/N_0 - 1), the usual linear term; never below zero. Source: Pacejka, Tire and Vehicle Dynamics, 3rd ed.
    2012, eq 4.E13 has it as p_Dx2.
    """
    return max(1.0 - tyre.load_sensitivity * (load / tyre.nominal_load - 1.0), 0.0)


# The least speed at which a contact is renewed [m/s]: at rest, too, it forgets within a second or two that it has slid.
# An assumption: static friction comes back in about that time.
RENEWAL = 0.05

# The slip of the contact lags at least so long [s], however fast the wheel turns: steps of 1 ms have to follow it.
SHORTEST_LAG = 1e-3


@inlined
def force_and_rate(
    deflection: float, slip_velocity: float, transport: float, secant: float, stiffness: float, damping: float
) -> tuple[float, float]:
    """Force of the road on the tyre [N] and rate of the deflection [m/s] of one direction, below the friction limit.

    Deflection u [m], slip velocity v [m/s], transport velocity V_t [m/s], secant stiffness f of the friction curve
    [N], carcass stiffness k [N/m] and damping d [N s/m]. Source: Rill 2006.
    """
    spring = stiffness * deflection
    contact = 1.0 / (secant + transport * damping)
    force = secant * (spring + damping * slip_velocity) * contact
    rate = (secant * slip_velocity - transport * spring) * contact
    return force, rate


@inlined
def slip_rate(slip: float, sliding: float, transport: float, contact_length: float) -> float:
    """Rate of the slip S of the contact [1/s], which slides with w = v - u' at a transport velocity [m/s]."""
    return (sliding - max(transport, RENEWAL) * slip) / (contact_length + transport * SHORTEST_LAG)
