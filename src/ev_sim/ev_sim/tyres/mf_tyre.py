"""The Magic Formula with load dependence and combined slip, for tyres that stand upright.

How it works: `at_load` makes peaks, stiffness factors and curvatures of a load, `forces` the forces
at slips. Neither has a branch on what changes within a run, so the compiler evaluates the formula
for the four wheels at once; the `plain` form leaves out what most tyre files do not have.
"""

from __future__ import annotations

from typing import NamedTuple

from ev_core.elementary.unbranched import (
    cosine_of_multiple,
    first_quadrant,
    moderate_exp,
    sine_of_multiple,
)
from ev_core.law import inlined, sqrt
from ev_core.vehicle.tyre import MfTyres

# Least share of the nominal load at which coefficients are taken: files are measured from about
# there on, and their polynomials may lose their sign further out. Likewise the largest. Both are
# assumptions.
LEAST_LOAD, LARGEST_LOAD = 0.05, 3.0


class MfTyre(NamedTuple):
    """The tyre of one wheel: the numbers of all tyres, its wheel, and `is_plain` of the tyres."""

    numbers: MfTyres
    i: int
    plain: bool


class AtLoad(NamedTuple):
    """Stiffness factors, peaks and curvatures at a load."""

    peak_x: float  # D_x [N]
    factor_x: float  # B_x [1]
    curvature_x: float  # E_x [1] without sign of the slip
    peak_y: float  # D_y [N]
    factor_y: float  # B_y [1]
    curvature_y: float  # E_y [1]
    change: float  # df_z [1]


def is_plain(tyres: MfTyres) -> bool:
    """True if the formula is shorter: slip angles by tangent, weights without curvature."""
    curvatures = (*tyres.rex1, *tyres.rex2, *tyres.rey1, *tyres.rey2)
    straight = all(value == 0.0 for value in curvatures)
    return straight and set(tyres.pky4) == {2.0} and set(tyres.takes_tangent) == {1.0}


@inlined
def at_load(tyre: MfTyre, load: float, grip: float, stiffness: float) -> AtLoad:
    """Peaks [N], stiffness factors and curvatures [1] of a tyre at a load [N].

    `grip` [1] scales the friction and leaves the slip stiffness (lambda_mu of the road),
    `stiffness` [1] the slip stiffness of a soft tyre. Source: Pacejka 2012, eqs 4.E2, 4.E11 to
    4.E15, 4.E21 to 4.E26, camber and pressure left out.
    """
    tyres, i, plain = tyre
    counted = min(max(load / tyres.fnomin[i], LEAST_LOAD), LARGEST_LOAD)
    change = counted - 1.0
    friction_x = (tyres.pdx1[i] + tyres.pdx2[i] * change) * grip
    friction_y = (tyres.pdy1[i] + tyres.pdy2[i] * change) * grip
    # Over load.
    slip_stiffness = (tyres.pkx1[i] + tyres.pkx2[i] * change) * moderate_exp(tyres.pkx3[i] * change)
    # Over load, with the ratio of the load to that of the largest stiffness; sin(2 atan x) is
    # 2 x/(1 + x^2).
    if plain:
        share = 2.0 * tyres.pky2[i]
        of = tyres.pky2[i] * tyres.pky2[i] + counted * counted
    else:
        share = sine_of_multiple(tyres.pky4[i], counted, tyres.pky2[i])
        of = counted
    # One division for both.
    stiff_x = tyres.pcx1[i] * friction_x
    stiff_y = tyres.pcy1[i] * friction_y * of
    softening = stiffness / (stiff_x * stiff_y)
    return AtLoad(
        peak_x=friction_x * load,
        factor_x=slip_stiffness * stiff_y * softening,
        curvature_x=tyres.pex1[i] + (tyres.pex2[i] + tyres.pex3[i] * change) * change,
        peak_y=friction_y * load,
        factor_y=tyres.pky1[i] * share * stiff_x * softening,
        curvature_y=min(tyres.pey1[i] + tyres.pey2[i] * change, 1.0),
        change=change,
    )


@inlined
def forces(
    tyre: MfTyre, loaded: AtLoad, slip_ratio: float, tangent: float, direction: float
) -> tuple[float, float]:
    """Sizes of longitudinal and side force [N] at a slip ratio and a tangent of the slip angle [1].

    Neither slip is negative. The slip ratio is over the speed along the wheel; the `direction` of
    its force, 1 while the wheel drives and -1 while it brakes, is its sign. Source: Pacejka 2012,
    eqs 4.E9, 4.E19 (pure slip) and 4.E50 to 4.E65 (combined slip).
    """
    tyres, i, plain = tyre
    angle = tangent
    if not plain:
        arc = first_quadrant(tangent, 1.0)
        angle = tangent if tyres.takes_tangent[i] == 1.0 else arc
    curvature = min(loaded.curvature_x * (1.0 - direction * tyres.pex4[i]), 1.0)
    bent_x = _bent(loaded.factor_x * slip_ratio, curvature)
    pure_x = loaded.peak_x * sine_of_multiple(tyres.pcx1[i], bent_x, 1.0)
    bent_y = _bent(loaded.factor_y * angle, loaded.curvature_y)
    pure_y = loaded.peak_y * sine_of_multiple(tyres.pcy1[i], bent_y, 1.0)
    # cos(atan x) = 1/sqrt(1 + x x)
    side = tyres.rbx2[i] * slip_ratio
    across, over_x = abs(tyres.rbx1[i]) * angle, sqrt(1.0 + side * side)
    along = tyres.rby2[i] * angle
    shift = tyres.rhy1[i] + tyres.rhy2[i] * loaded.change
    factor, over_y = abs(tyres.rby1[i]), sqrt(1.0 + along * along)
    centred = factor * abs(shift)
    shifted = factor * abs(direction * slip_ratio + shift)
    if not plain:
        across = _bent(across / over_x, min(tyres.rex1[i] + tyres.rex2[i] * loaded.change, 1.0))
        curvature = min(tyres.rey1[i] + tyres.rey2[i] * loaded.change, 1.0)
        centred = _bent(centred / over_y, curvature)
        shifted = _bent(shifted / over_y, curvature)
        over_x, over_y = 1.0, 1.0
    weight_x = cosine_of_multiple(tyres.rcx1[i], across, over_x)
    shape = tyres.rcy1[i]
    weight_y = cosine_of_multiple(shape, shifted, over_y)
    weight_y = weight_y / cosine_of_multiple(shape, centred, over_y)
    return pure_x * weight_x, pure_y * weight_y


@inlined
def _bent(x: float, curvature: float) -> float:
    """Number x - E (x - atan x); the Magic Formula takes its arc tangent."""
    return x - curvature * (x - first_quadrant(x, 1.0))


def cornering_stiffness(
    tyres: MfTyres, i: int, load: float, grip: float, stiffness: float
) -> float:
    """Slope of the side force over the slip angle [N/rad] at zero slip of the tyre of wheel i.

    `grip` and `stiffness` are those of `at_load`.
    """
    loaded = at_load(MfTyre(tyres, i, is_plain(tyres)), load, grip, stiffness)
    return loaded.factor_y * tyres.pcy1[i] * loaded.peak_y
