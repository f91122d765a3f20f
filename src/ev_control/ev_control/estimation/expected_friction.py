"""Stored phi-s diagrams: longitudinal friction over slip, for a slip angle and a largest friction coefficient.

The dissertation (section 1.4) names them and gives none. Here they are one family: the resultant slip
s_r = sqrt(s^2 + tan(alpha)^2) uses mu = mu_max 2 x/(1 + x^2), x = s_r/s_p, up to its peak at s_p and mu_max beyond, in
the direction of the slip vector. s_p = first + growth mu_max follows the peaks of Burckhardt's curves.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import compilable, parameter, sqrt


@dataclass(frozen=True, slots=True)
class FrictionDiagramParameters:
    """Where the peak of a diagram lies."""

    first: float = parameter(
        0.045,
        unit="1",
        low=1e-3,
        high=1.0,
        about="slip of the peak on a road without friction; with the growth it is within 0.01 of Burckhardt's peaks on "
        "snow and wet asphalt",
    )
    growth: float = parameter(0.11, unit="1", low=0.0, high=1.0, about="growth of that slip with mu_max")


@compilable
def peak_slip(p: FrictionDiagramParameters, largest: float) -> float:
    """Resultant slip of the peak [1] on a road with this largest friction coefficient [1]."""
    return p.first + p.growth * largest


@compilable
def expected_friction(p: FrictionDiagramParameters, largest: float, slip: float, lateral: float) -> float:
    """Longitudinal friction [1] at a slip and a lateral slip tan(alpha) [1]; phi_y is the same with both exchanged."""
    resultant = sqrt(slip * slip + lateral * lateral)
    if resultant == 0.0:
        return 0.0
    x = min(resultant / peak_slip(p, largest), 1.0)
    return largest * (2.0 * x / (1.0 + x * x)) * slip / resultant


@compilable
def friction_at_peak(p: FrictionDiagramParameters, largest: float, lateral: float) -> float:
    """Longitudinal friction [1] at the peak of the resultant slip, beside a lateral slip [1]; zero beyond.

    More slip would turn the rest of the friction along as well, and leave nothing across.
    """
    use = lateral / peak_slip(p, largest)
    return largest * sqrt(max(1.0 - use * use, 0.0))
