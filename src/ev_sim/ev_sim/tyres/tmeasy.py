"""TMeasy: forces over the slip with load dependence and combined slip, for upright tyres.

How it works: each force has a curve with five numbers (`Curve`): its slope at zero slip, the peak
and its slip, and the sliding force with the slip from which on the contact slides. `at_load` makes
them of a load from those at two loads, `towards` those in a direction between along and across, and
`over_slip` evaluates the curve. Forces are over the load throughout, so a wheel that lifts off
needs no case of its own. Source: G. Rill, Road Vehicle Dynamics, 2012, and with A. A. Castro, 2nd
ed. 2020, chapter on the tyre.
"""

from __future__ import annotations

from typing import NamedTuple

from ev_core.law import inlined, sqrt
from ev_core.vehicle.tmeasy import LARGEST_LOAD, TmeasyCurve, TmeasyTyre, linear


class Curve(NamedTuple):
    """One force over the load, over its slip."""

    slope: float  # dF_0/F_z, at zero slip [1]
    peak_slip: float  # s_M [1]
    peak: float  # F_M/F_z [1]
    full_slip: float  # s_S [1], from which on the whole contact slides
    sliding: float  # F_S/F_z [1]


class Normalized(NamedTuple):
    """Both curves at a load, and what slips along and across are over to be normalized [1]."""

    along: Curve
    across: Curve
    along_of: float
    across_of: float


@inlined
def _quadratic(at_nominal: float, at_double: float, share: float) -> float:
    """A force over the load, times the nominal load [N], at a load over the nominal one.

    The force is a parabola through zero; over the load it is a line.
    """
    return 2.0 * at_nominal - 0.5 * at_double - (at_nominal - 0.5 * at_double) * share


@inlined
def _curve_at(
    of: TmeasyCurve, nominal: float, share: float, grip: float, stiffness: float
) -> Curve:
    """The curve of a force at a load over the `nominal` one [N]."""
    # Less friction takes the peak to a smaller slip, on the same slope (Rill: mu_L/mu_0); a softer
    # tyre takes all of the curve to a larger one.
    stretched = grip / stiffness
    peak = grip * _quadratic(of.fm_pn, of.fm_p2n, share) / nominal
    # At loads far from both it might pass the peak.
    sliding = min(grip * _quadratic(of.fs_pn, of.fs_p2n, share) / nominal, peak)
    return Curve(
        slope=stiffness * _quadratic(of.df0_pn, of.df0_p2n, share) / nominal,
        peak_slip=stretched * linear(of.sm_pn, of.sm_p2n, share),
        peak=peak,
        full_slip=stretched * linear(of.ss_pn, of.ss_p2n, share),
        sliding=sliding,
    )


@inlined
def at_load(tyre: TmeasyTyre, load: float, grip: float, stiffness: float) -> Normalized:
    """Both curves of a tyre at a load [N].

    `grip` [1] scales the friction, `stiffness` [1] the slope of a soft tyre.
    """
    share = min(load / tyre.pn, LARGEST_LOAD)
    along = _curve_at(tyre.along, tyre.pn, share, grip, stiffness)
    across = _curve_at(tyre.across, tyre.pn, share, grip, stiffness)
    slips = along.peak_slip + across.peak_slip
    # The slips at which straight lines of the slopes reach the peaks.
    straight_x = along.peak / along.slope
    straight_y = across.peak / across.slope
    straight = straight_x + straight_y
    return Normalized(
        along=along,
        across=across,
        along_of=along.peak_slip / slips + straight_x / straight,
        across_of=across.peak_slip / slips + straight_y / straight,
    )


@inlined
def _resulting(along: float, across: float, cosine: float, sine: float) -> float:
    x = along * cosine
    y = across * sine
    return sqrt(x * x + y * y)


@inlined
def towards(of: Normalized, cosine: float, sine: float) -> Curve:
    """The curve over the normalized slip in a direction; 1 and 0 are along the wheel."""
    x, y, x_of, y_of = of
    return Curve(
        slope=_resulting(x.slope * x_of, y.slope * y_of, cosine, sine),
        peak_slip=_resulting(x.peak_slip / x_of, y.peak_slip / y_of, cosine, sine),
        peak=_resulting(x.peak, y.peak, cosine, sine),
        full_slip=_resulting(x.full_slip / x_of, y.full_slip / y_of, cosine, sine),
        sliding=_resulting(x.sliding, y.sliding, cosine, sine),
    )


@inlined
def over_slip(c: Curve, slip: float) -> float:
    """Force over load and slip [1] at a slip above 0 [1].

    Up to the peak a fraction, behind it a parabola as curved as the fraction is there, and a second
    one that ends level where all of the contact slides.
    """
    if slip >= c.full_slip:
        return c.sliding / slip
    # In directions between both axes the line of a smaller slope would not reach the peak.
    slope = max(c.slope, 2.0 * c.peak / c.peak_slip)
    if slip < c.peak_slip:
        part = slip / c.peak_slip
        return slope / (1.0 + part * (part + slope * c.peak_slip / c.peak - 2.0))
    beyond = slip - c.peak_slip
    width = c.full_slip - c.peak_slip
    fall = c.peak - c.sliding
    curvature = (c.peak / c.peak_slip) * (c.peak / c.peak_slip) / (slope * c.peak_slip)
    joint = fall / (curvature * width)
    if joint >= width:
        # So steep a fall leaves no room for two parabolas: one cubic, level at both ends.
        part = beyond / width
        force = c.peak - fall * part * part * (3.0 - 2.0 * part)
    elif beyond <= joint:
        force = c.peak - curvature * beyond * beyond
    else:
        left = c.full_slip - slip
        force = c.sliding + curvature * joint / (width - joint) * left * left
    return force / slip


def cornering_stiffness(tyre: TmeasyTyre, load: float, grip: float, stiffness: float) -> float:
    """Slope of the side force over the slip angle [N/rad] at zero slip and a load [N]."""
    return load * at_load(tyre, load, grip, stiffness).across.slope
