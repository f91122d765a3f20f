"""Between rim and road: combined slip of the tyre, and the carcass between rim and contact patch.

How it works: along and across the wheel alike, a carcass (a spring and a damper) lies in series
with a contact that slides. The friction curve gives the contact a force over its slip; that force
over the slip is the secant. With it the contact is a viscous element, and equal forces in carcass
and contact give the force and the rate of the deflection (`force_and_rate`). A secant is finite at
rest, where the slip itself is 0/0, so rest needs no case of its own.
"""

from __future__ import annotations

from ev_core.law import inlined, sqrt
from ev_core.vehicle.tyre import Tyre
from ev_sim.tyres.curve import DRY_FRICTION, SLIP_FLOOR, Coefficients, dry_friction, secant
from ev_sim.tyres.mf_tyre import AtLoad, MfTyre, forces
from ev_sim.tyres.tmeasy import Normalized, over_slip, towards

Pair = tuple[float, float]  # along and across the wheel

COMBINATIONS = ("slip_vector", "uncoupled", "weighted", "normalized")
SLIP_VECTOR, UNCOUPLED, WEIGHTED, NORMALIZED = range(len(COMBINATIONS))

# Transport velocity below which slip loses its meaning; far below any motion, it keeps 0/0 away.
STILL = 1e-9

# The least speed at which a contact is renewed [m/s]: at rest, too, it forgets within a second or
# two that it has slid. An assumption: static friction comes back in about that time.
RENEWAL = 0.05

# The slip of the contact lags at least so long [s], however fast the wheel turns: steps of 1 ms
# have to follow it.
SHORTEST_LAG = 1e-3

# How far the slip of the velocities may be ahead of that of the contact [1]: a wheel that starts to
# turn at rest has a slip of 1 at once, while nothing slides yet. An assumption, about the slip of
# the peak: a contact that sticks comes up to the peak of any curve, and driving above walking speed
# hardly ever meets it.
AHEAD = 0.1

# The least speed along the wheel over the transport velocity [1]: a wheel that spins on the spot or
# slides sideways has a slip ratio or a tangent of 50, where the formula has long come to its end.
LEAST_ROLLING = 0.02


@inlined
def sensitivity(tyre: Tyre, load: float) -> float:
    """Share [1] of friction and slip stiffness over load that is left at a load [N].

    1 - e (N/N_0 - 1), the usual linear term; never below zero. Source: Pacejka, Tire and Vehicle
    Dynamics, 3rd ed. 2012, eq 4.E13 has it as p_Dx2.
    """
    return max(1.0 - tyre.load_sensitivity * (load / tyre.nominal_load - 1.0), 0.0)


@inlined
def force_and_rate(
    deflection: float,
    slip_velocity: float,
    transport: float,
    secant: float,
    stiffness: float,
    damping: float,
) -> Pair:
    """Force of the road [N] and rate of the deflection [m/s] in one direction, friction unlimited.

    Deflection u [m], slip velocity v [m/s], transport velocity V_t [m/s], secant stiffness f of the
    friction curve [N], carcass stiffness k [N/m] and damping d [N s/m]. Source: Rill 2006.
    """
    # Carcass F = k u + d u', contact F = f (v - u')/V_t, solved for F and u'.
    spring = stiffness * deflection
    contact = 1.0 / (secant + transport * damping)
    force = secant * (spring + damping * slip_velocity) * contact
    rate = (secant * slip_velocity - transport * spring) * contact
    return force, rate


@inlined
def slip_rate(slip: float, sliding: float, transport: float, contact_length: float) -> float:
    """Rate of the slip S of the contact [1/s].

    It slides with w = v - u' [m/s] at a transport velocity [m/s].
    """
    # By travelled distance while the wheel rolls: over a length of the contact the slip is renewed.
    renewed = max(transport, RENEWAL) * slip
    return (sliding - renewed) / (contact_length + transport * SHORTEST_LAG)


@inlined
def slip_vector(
    tyre: Tyre, on_road: Coefficients, slid: Pair, transport: float, contact: Pair
) -> Pair:
    """Friction per longitudinal and per lateral slip [1], both by one curve over their sum.

    Slip velocities [m/s] over the transport velocity [m/s] give the slip vector; the tyre's
    `lateral_ratio` [1] stretches its lateral component where it is stiffer or softer sideways. Of
    the resulting slip counts what is at most `AHEAD` of that of the contact [1]. Source: Kiencke &
    Nielsen, Automotive Control Systems, 2nd ed. 2005, wheel model.
    """
    stretched = tyre.lateral_ratio * slid[1]
    resulting = sqrt(slid[0] * slid[0] + stretched * stretched)
    if tyre.curve == DRY_FRICTION:
        # Over the slip speed itself, which has no full slip.
        speed = max(resulting, SLIP_FLOOR)
        use = dry_friction(speed, on_road.c0, on_road.c1, on_road.c2, on_road.c3)
        # `force_and_rate` divides by the transport velocity, which has no part in this friction.
        rubbed = transport * (use / speed)
        return rubbed, tyre.lateral_ratio * rubbed
    slip = resulting / transport
    if slip > AHEAD:
        contact_y = tyre.lateral_ratio * contact[1]
        slip = min(slip, AHEAD + sqrt(contact[0] * contact[0] + contact_y * contact_y))
    common = secant(tyre.curve, slip, on_road)
    return common, tyre.lateral_ratio * common


@inlined
def uncoupled(
    tyre: Tyre, on_road: Coefficients, slid: Pair, transport: Pair, contact: Pair
) -> Pair:
    """Friction per longitudinal and per lateral slip [1], each by the curve on its own.

    Slip and transport velocities [m/s] and slips of the contact [1] of the two directions. Source:
    Tatar & Chudzik (their F_p and F_b).
    """
    ratio = tyre.lateral_ratio
    along = min(abs(slid[0]) / transport[0], AHEAD + abs(contact[0]))
    across = min(ratio * abs(slid[1]) / transport[1], AHEAD + ratio * abs(contact[1]))
    longitudinal = secant(tyre.curve, along, on_road)
    return longitudinal, ratio * secant(tyre.curve, across, on_road)


@inlined
def _counted(
    slip: Pair, reference: float, transport: float, contact: Pair
) -> tuple[float, float, float]:
    """Share of the slip velocities that counts [m/s], and what it and all are over [m^2/s^2].

    Slip velocities over the transport velocity [m/s] give slips; those of a formula are over the
    speed `reference` [m/s]. As with one curve, of the resulting slip counts what is at most
    `AHEAD` of that of the contact [1].
    """
    slip_x, slip_y = slip
    contact_x, contact_y = contact
    slid = max(sqrt(slip_x * slip_x + slip_y * slip_y), AHEAD * transport)
    held = AHEAD + sqrt(contact_x * contact_x + contact_y * contact_y)
    counted = min(slid, held * transport)
    # What counts of the slip velocities, over what is left of the reference speed, both times
    # `slid`.
    full = slid * transport
    left = full - counted * (transport - min(abs(reference), transport))
    return counted, max(left, LEAST_ROLLING * full), full


@inlined
def weighted(
    tyre: MfTyre, loaded: AtLoad, slip: Pair, along: float, transport: float, contact: Pair
) -> Pair:
    """Force over slip along and across the wheel [N], by the Magic Formula at a load.

    Its slips are over the speed `along` the wheel [m/s] (`_counted`).
    """
    slip_x, slip_y = slip
    counted, rolling, full = _counted(slip, along, transport, contact)
    scale = counted / rolling
    slip_ratio = max(abs(slip_x) * scale, SLIP_FLOOR)
    tangent = max(abs(slip_y) * scale, SLIP_FLOOR)
    direction = 1.0 if slip_x * along >= 0.0 else -1.0
    force_x, force_y = forces(tyre, loaded, slip_ratio, tangent, direction)
    # One division for both: each force is over its own slip, so the other slip cancels. Friction
    # never pushes, whatever a formula gives far from where it was measured.
    secant = full / (rolling * slip_ratio * tangent)
    return max(force_x, 0.0) * (secant * tangent), max(force_y, 0.0) * (secant * slip_ratio)


@inlined
def normalized(of: Normalized, slip: Pair, rim: float, transport: float, contact: Pair) -> Pair:
    """Friction per longitudinal and per lateral slip [1], by TMeasy at a load.

    Its slips are over the speed of the `rim` [m/s] (`_counted`), and each over a number of its own
    the normalized one. One curve over their sum holds in the direction of both. Source: Rill 2012,
    section on combined forces.
    """
    counted, rolling, full = _counted(slip, rim, transport, contact)
    scale = counted / rolling
    slip_x = max(abs(slip[0]) * scale / of.along_of, SLIP_FLOOR)
    slip_y = max(abs(slip[1]) * scale / of.across_of, SLIP_FLOOR)
    resulting = sqrt(slip_x * slip_x + slip_y * slip_y)
    common = over_slip(towards(of, slip_x / resulting, slip_y / resulting), resulting)
    # Over the slip of the plant, which is over the transport velocity.
    common *= full / rolling
    return common / of.along_of, common / of.across_of
