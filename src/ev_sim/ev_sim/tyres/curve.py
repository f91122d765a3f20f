"""The friction curves of tyres over the slip, by name, their peaks, and those of softer tyres.

How it works: each curve is a function of the slip and four coefficients, chosen by its place in
FRICTION_CURVES (`friction`). A plant takes the `secant`, friction over slip, which is finite at
rest. Peaks are searched once, before a run.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from ev_core.law import atan, compilable, exp, inlined, sin
from ev_core.vehicle.tyre import POSITIVE_COEFFICIENTS

# One curve over the slip each, but for dry_friction over the slip speed, and those with load
# dependence (`mf_tyre.forces`, `tmeasy.over_slip`).
FRICTION_CURVES = tuple(POSITIVE_COEFFICIENTS)
BURCKHARDT = FRICTION_CURVES.index("burckhardt")
RATIONAL = FRICTION_CURVES.index("rational")
TWO_EXPONENTIAL = FRICTION_CURVES.index("two_exponential")
MAGIC_FORMULA = FRICTION_CURVES.index("magic_formula")
LINEAR_FRICTION = FRICTION_CURVES.index("linear")
MF_TYRE = FRICTION_CURVES.index("mf_tyre")
DRY_FRICTION = FRICTION_CURVES.index("dry_friction")
TMEASY = FRICTION_CURVES.index("tmeasy")
# Places of the coefficients that are in proportion to the friction of the road. A linear tyre keeps
# its slope; Burckhardt's coefficients are those of the surface, tyres with load dependence have a
# scale of their own.
SCALED_BY_FRICTION = {
    "rational": (0,),
    "two_exponential": (0,),
    "magic_formula": (2,),
    "dry_friction": (0, 2),
    "linear": (),
}
# Slip at which the slope of a curve at zero slip is taken: small against any peak, large against
# rounding.
SLIP_FLOOR = 1e-6
# The grid in slip on which the peak is looked for: cells of so many steps first, then step by step.
_STEP = 1e-4
_CELL = 100
_STEPS = 10000


@inlined
def burckhardt(slip: float, c1: float, c2: float, c3: float, _unused: float) -> float:
    """Friction use over slip, phi = C1 (1 - exp(-C2 S)) - C3 S.

    Slip S [1] is at least 0; returns [1]. Source: dissertation, table 2.3; Kiencke & Nielsen,
    Automotive Control Systems, 2nd ed. 2005, chapter on vehicle modelling.
    """
    return c1 * (1.0 - exp(-c2 * slip)) - c3 * slip


@inlined
def linear(slip: float, slope: float, _second: float, _third: float, _fourth: float) -> float:
    """Friction use over slip, mu = c S, without a peak.

    Slip S [1] is at least 0; `slope` is c, the slip stiffness per load [1]; returns [1].
    """
    return slope * slip


@inlined
def magic_formula(slip: float, b: float, c: float, d: float, e: float) -> float:
    """Friction use over slip, mu = D sin(C atan(B S - E (B S - atan(B S)))).

    Slip S [1] is at least 0; stiffness factor B, shape factor C, peak D, curvature factor E [1];
    returns [1]. Source: Pacejka, Tire and Vehicle Dynamics, 3rd ed. 2012, section 4.3, without
    shifts.
    """
    bs = b * slip
    return d * sin(c * atan(bs - e * (bs - atan(bs))))


@inlined
def rational(slip: float, peak: float, peak_slip: float, _third: float, _fourth: float) -> float:
    """Friction use over slip, mu = 2 mu_p l_p l / (l^2 + l_p^2).

    Slip l [1] is at least 0; `peak` is mu_p [1] at the slip `peak_slip` l_p [1]; returns [1].
    Source: Ge & Ni 2005, tyre model.
    """
    return 2.0 * peak * peak_slip * slip / (slip * slip + peak_slip * peak_slip)


@inlined
def two_exponential(
    slip: float, full_slip: float, rise: float, fall: float, _fourth: float
) -> float:
    """Friction use over slip, mu = mu_s (1 - exp(-S/S0)) (1 + exp(-S/S1)).

    Slip S [1] is at least 0; `full_slip` is mu_s [1], `rise` S0 and `fall` S1 [1]; returns [1].
    Source: Zhileykin & Eranosyan 2018, tyre model.
    """
    return full_slip * (1.0 - exp(-slip / rise)) * (1.0 + exp(-slip / fall))


@inlined
def dry_friction(
    speed: float, adhesion: float, adhesion_speed: float, sliding: float, sliding_speed: float
) -> float:
    """Friction use over slip speed: it rises to `adhesion` and falls to `sliding`.

    Both cubics end level. Slip speed [m/s] is at least 0; mu_A, mu_S [1] at the speeds v_A < v_S
    [m/s]; returns [1]. Source: Modelica library PlanarMechanics, DryFrictionWheelJoint and
    limitByStriple.
    """
    if speed <= adhesion_speed:
        x = speed / adhesion_speed
        return adhesion * x * (1.5 - 0.5 * x * x)
    x = 2.0 * min((speed - adhesion_speed) / (sliding_speed - adhesion_speed), 1.0) - 1.0
    return 0.5 * (adhesion + sliding + (sliding - adhesion) * x * (1.5 - 0.5 * x * x))


class Coefficients(NamedTuple):
    """Coefficients of a friction curve, in the order of its function."""

    c0: float
    c1: float
    c2: float
    c3: float


@inlined
def friction(curve: float, slip: float, c: Coefficients) -> float:
    """Friction use [1] at a slip [1], or slip speed [m/s], from 0 on.

    The curve is a place in FRICTION_CURVES.
    """
    if curve == BURCKHARDT:
        return burckhardt(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == RATIONAL:
        return rational(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == TWO_EXPONENTIAL:
        return two_exponential(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == MAGIC_FORMULA:
        return magic_formula(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == DRY_FRICTION:
        return dry_friction(slip, c.c0, c.c1, c.c2, c.c3)
    return linear(slip, c.c0, c.c1, c.c2, c.c3)


@inlined
def secant(curve: float, slip: float, c: Coefficients) -> float:
    """Friction use divided by slip [1], finite at zero slip, never negative.

    The curves are measured up to full slip; beyond it (wheel and road run against each other, or
    the wheel spins backwards) the friction of full slip is kept, an assumption that keeps
    Burckhardt's straight term from pushing.
    """
    slip = max(slip, SLIP_FLOOR)
    return friction(curve, min(slip, 1.0), c) / slip


@inlined
def largest(curve: float, available: float, c: Coefficients) -> float:
    """Largest friction use up to full slip [1]: for all curves but the line the available one."""
    return c.c0 if curve == LINEAR_FRICTION else available


def peak(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """Largest friction use up to full slip, or at any slip speed [1]: the available friction.

    `peak_slip` is where it is reached.
    """
    return friction(
        FRICTION_CURVES.index(curve), peak_slip(curve, coefficients), Coefficients(*coefficients)
    )


@cache
def peak_slip(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """Slip [1] of the largest friction use, on a grid of 1e-4; 1 for a curve that only rises.

    The curves rise to one peak and then fall: around the highest of every hundredth point lies the
    highest of all. Of dry friction it is a slip speed [m/s], where one cubic goes over into the
    next.
    """
    of, c = FRICTION_CURVES.index(curve), Coefficients(*coefficients)
    if of == DRY_FRICTION:
        return c.c1 if c.c0 >= c.c2 else c.c3

    def highest(places: range) -> int:
        return max(places, key=lambda place: friction(of, place * _STEP, c))

    # The cell before and the one behind the highest coarse point hold the peak.
    coarse = highest(range(0, _STEPS + 1, _CELL))
    return highest(range(max(coarse - _CELL, 0), min(coarse + _CELL, _STEPS) + 1)) * _STEP


@compilable
def soften(curve: float, tyre: Any, share: float) -> None:
    """Soften a tyre: give at a slip what it gave at `share` [1] of it.

    The record has the coefficients c0 to c3 of the curve. The slope at zero slip is `share` of what
    it was, the peak is as high as before.
    """
    if curve == BURCKHARDT:
        tyre.c1 *= share
        tyre.c2 *= share
    elif curve == RATIONAL:
        tyre.c1 /= share
    elif curve == TWO_EXPONENTIAL:
        tyre.c1 /= share
        tyre.c2 /= share
    elif curve == DRY_FRICTION:
        tyre.c1 /= share
        tyre.c3 /= share
    elif curve in (MAGIC_FORMULA, LINEAR_FRICTION):
        tyre.c0 *= share
    elif curve in (MF_TYRE, TMEASY):
        tyre.c1 *= share
