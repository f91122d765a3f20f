"""The carcass: a spring and a damper between rim and contact patch, in series with the sliding contact.

The contact patch carries the steady force f s of the friction curve, with slip s = (v - u')/V_t: a viscous element
of coefficient f/V_t. The carcass carries k u + d u'. Equating both gives the tyre of first order of Rill (First order
tire dynamics, III European Conference on Computational Mechanics, Lisbon 2006):

    u' = (f v - V_t k u) / (f + V_t d),    F = f (k u + d v) / (f + V_t d)

At speed the steady force of the curve is reached over the relaxation length (f + V_t d)/k; at rest (V_t = 0) the
contact sticks and the carcass is a damped spring. No eigenvalue exceeds k/d, so an explicit step that suits the
carcass suits every speed, and F v = d/dt(k u^2 / 2) + d u'^2 + (f/V_t)(v - u')^2 shows that it never gives energy.
"""

from ev_msgs_py.compiling.compilable import inlined


@inlined
def force_and_rate(
    deflection: float, slip_velocity: float, transport: float, secant: float, stiffness: float, damping: float
) -> tuple[float, float]:
    """Force of the road on the tyre [N] and rate of the deflection [m/s] of one direction.

    Deflection u [m], slip velocity v [m/s], transport velocity V_t [m/s], secant stiffness f of the friction curve
    [N], carcass stiffness k [N/m] and damping d [N s/m]. Source: Rill 2006.
    """
    spring = stiffness * deflection
    contact = 1.0 / (secant + transport * damping)
    force = secant * (spring + damping * slip_velocity) * contact
    rate = (secant * slip_velocity - transport * spring) * contact
    return force, rate
