"""The carcass, in series with the sliding contact; and the load that tyres with one curve do not carry in full.

Of the slip velocity v at the rim the carcass takes u', and w = v - u' slides in the contact, with slip s = w/V_t. The
contact carries the steady force f s of the friction curve, a viscous element of coefficient f/V_t, the carcass
k u + d u'. Equating both gives the tyre of first order of Rill (First order tire dynamics, III European Conference on
Computational Mechanics, Lisbon 2006):

    u' = (f v - V_t k u) / (f + V_t d),    F = f (k u + d v) / (f + V_t d)

At speed the steady force of the curve is reached over the relaxation length (f + V_t d)/k; at rest (V_t = 0) the
contact sticks and the carcass is a damped spring. No eigenvalue exceeds k/d, so an explicit step that suits the
carcass suits every speed, and F v = d/dt(k u^2 / 2) + d u'^2 + F w shows that it never gives energy.

f = N mu(s)/s is taken at s = v/V_t. A wheel that starts to turn at rest has s = 1 at once, but as long as its carcass
takes all of v nothing slides, and the force is to follow the deflection up to the peak of the curve, not to the
friction of full slip. So s counts no further than a little ahead of the slip S that the contact has, which builds up as
it slides over a contact length l (contact relaxation length, Pacejka, Tire and Vehicle Dynamics, 2012, chapter 8):

    S' = (w - V_t S) / l

No force is above the peak, not even where load or friction fall below what the carcass holds: then the contact slides
with the force of the peak, and u' = (F - k u)/d.
"""

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
