"""The friction curve of a tyre, chosen by name."""

from __future__ import annotations

from ev_sim.compiled import compiled
from ev_sim.tyres import burckhardt, linear, magic_formula, rational, two_exponential

CURVES = ("burckhardt", "rational", "two_exponential", "magic_formula", "linear")

_BURCKHARDT = CURVES.index("burckhardt")
_RATIONAL = CURVES.index("rational")
_TWO_EXPONENTIAL = CURVES.index("two_exponential")
_MAGIC_FORMULA = CURVES.index("magic_formula")

# Slip at which the slope of a curve at zero slip is taken: small against any peak, large against rounding.
SLIP_FLOOR = 1e-6


@compiled
def friction(curve: int, slip: float, c0: float, c1: float, c2: float, c3: float) -> float:
    """Friction use [1] at a slip [1] of at least 0, of the curve with this index in `CURVES`.

    The coefficients c0..c3 are those of the curve's own module, in its order.
    """
    if curve == _BURCKHARDT:
        return burckhardt.friction(slip, c0, c1, c2, c3)
    if curve == _RATIONAL:
        return rational.friction(slip, c0, c1, c2, c3)
    if curve == _TWO_EXPONENTIAL:
        return two_exponential.friction(slip, c0, c1, c2, c3)
    if curve == _MAGIC_FORMULA:
        return magic_formula.friction(slip, c0, c1, c2, c3)
    return linear.friction(slip, c0, c1, c2, c3)


@compiled
def secant(curve: int, slip: float, c0: float, c1: float, c2: float, c3: float) -> float:
    """Friction use divided by slip [1], finite at zero slip, never negative.

    The curves are measured up to full slip; beyond it (wheel and road run against each other, or the wheel spins
    backwards) the friction of full slip is kept, an assumption that keeps Burckhardt's straight term from pushing.
    """
    slip = max(slip, SLIP_FLOOR)
    return friction(curve, min(slip, 1.0), c0, c1, c2, c3) / slip


def peak(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """The largest friction use up to full slip [1], the available friction; found on a grid of 1e-4 in slip."""
    return friction(CURVES.index(curve), peak_slip(curve, coefficients), *coefficients)


def peak_slip(curve: str, coefficients: tuple[float, float, float, float]) -> float:
    """The slip [1] of the largest friction use, on the grid of `peak`; 1 for a curve that only rises."""
    return _peak_slip(CURVES.index(curve), *coefficients)


@compiled
def _peak_slip(curve: int, c0: float, c1: float, c2: float, c3: float) -> float:
    best, highest = 0.0, friction(curve, 0.0, c0, c1, c2, c3)
    for index in range(1, 10001):
        here = friction(curve, index * 1e-4, c0, c1, c2, c3)
        if here > highest:
            best, highest = index * 1e-4, here
    return best
