"""The friction curve of a tyre, chosen by name."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_sim.tyres import burckhardt, linear, magic_formula, rational, two_exponential

# One curve over the slip each, but for mf_tyre (`mf_tyre.forces`).
CURVES = ("burckhardt", "rational", "two_exponential", "magic_formula", "linear", "mf_tyre")
BURCKHARDT, RATIONAL, TWO_EXPONENTIAL, MAGIC_FORMULA, LINEAR, MF_TYRE = range(len(CURVES))

# Slip at which the slope of a curve at zero slip is taken: small against any peak, large against rounding.
SLIP_FLOOR = 1e-6

# The grid in slip on which the peak is looked for: cells of so many steps first, then step by step.
_STEP, _CELL, _STEPS = 1e-4, 100, 10000


class Coefficients(NamedTuple):
    """Of a friction curve, those of the curve's own module in its order."""

    c0: float
    c1: float
    c2: float
    c3: float


@inlined
def friction(curve: float, slip: float, c: Coefficients) -> float:
    """Friction use [1] at a slip [1] of at least 0, of the curve with this place in `CURVES`."""
    if curve == BURCKHARDT:
        return burckhardt.friction(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == RATIONAL:
        return rational.friction(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == TWO_EXPONENTIAL:
        return two_exponential.friction(slip, c.c0, c.c1, c.c2, c.c3)
    if curve == MAGIC_FORMULA:
        return magic_formula.friction(slip, c.c0, c.c1, c.c2, c.c3)
    return linear.friction(slip, c.c0, c.c1, c.c2, c.c3)


@inlined
def secant(curve: float, slip: float, c: Coefficients) -> float:
    """Friction use divided by slip [1], finite at zero slip, never negative.

    The curves are measured up to full slip; beyond it (wheel and road run against each other, or the wheel spins
    backwards) the friction of full slip is kept, an assumption that keeps Burckhardt's straight term from pushing.
    """
    slip = max(slip, SLIP_FLOOR)
    return friction(curve, min(slip, 1.0), c) / slip


@inlined
def largest(curve: float, available: float, c: Coefficients) -> float:
    """The largest friction use up to full slip [1], which for all curves but the line is the available friction."""
    return c.c0 if curve == LINEAR else available


def peak(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """The largest friction use up to full slip [1], the available friction; on a grid of 1e-4 in slip."""
    return friction(CURVES.index(curve), peak_slip(curve, coefficients), Coefficients(*coefficients))


@cache
def peak_slip(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """The slip [1] of the largest friction use, on the grid of `peak`; 1 for a curve that only rises.

    The curves rise to one peak and then fall: around the highest of every hundredth point lies the highest of all.
    """
    of, c = CURVES.index(curve), Coefficients(*coefficients)

    def highest(places: range) -> int:
        return max(places, key=lambda place: friction(of, place * _STEP, c))

    coarse = highest(range(0, _STEPS + 1, _CELL))
    return highest(range(max(coarse - _CELL, 0), min(coarse + _CELL, _STEPS) + 1)) * _STEP
