"""The Magic Formula with load dependence and combined slip, for a tyre that stands upright."""

from __future__ import annotations

from typing import Any, NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import atan, cos, exp, sin, sqrt
from ev_msgs_py.vehicle.mf_tyre import MfTyre

# Least share of the nominal load whose coefficients are taken: files are measured from about there on, and their
# polynomials may lose their sign further out. Likewise the largest. Both are assumptions.
LEAST_LOAD, LARGEST_LOAD = 0.05, 3.0


class AtLoad(NamedTuple):
    """What the load decides: stiffness factors, peaks and curvatures."""

    peak_x: float  # D_x [N]
    factor_x: float  # B_x [1]
    curvature_x: float  # E_x [1] without sign of the slip
    peak_y: float  # D_y [N]
    factor_y: float  # B_y [1]
    curvature_y: float  # E_y [1]
    change: float  # df_z [1]


@inlined
def at_load(tyre: MfTyre, load: float, grip: float, stiffness: float) -> AtLoad:
    """Peaks [N], stiffness factors and curvatures [1] at a load [N].

    `grip` [1] scales the friction and leaves the slip stiffness (lambda_mu of the road), `stiffness` [1] the slip
    stiffness of a soft tyre. Source: Pacejka 2012, eqs 4.E2, 4.E11 to 4.E15, 4.E21 to 4.E26, camber and pressure left
    out.
    """
    counted = min(max(load / tyre.fnomin, LEAST_LOAD), LARGEST_LOAD)
    change = counted - 1.0
    friction_x = (tyre.pdx1 + tyre.pdx2 * change) * grip
    friction_y = (tyre.pdy1 + tyre.pdy2 * change) * grip
    slip_stiffness = (tyre.pkx1 + tyre.pkx2 * change) * exp(tyre.pkx3 * change)  # over load
    ratio = counted / tyre.pky2
    # sin(2 atan x) in every file of 5.2
    share = 2.0 * ratio / (1.0 + ratio * ratio) if tyre.pky4 == 2.0 else sin(tyre.pky4 * atan(ratio))
    cornering_stiffness = tyre.pky1 * share / counted  # over load
    return AtLoad(
        peak_x=friction_x * load,
        factor_x=stiffness * slip_stiffness / (tyre.pcx1 * friction_x),
        curvature_x=tyre.pex1 + (tyre.pex2 + tyre.pex3 * change) * change,
        peak_y=friction_y * load,
        factor_y=stiffness * cornering_stiffness / (tyre.pcy1 * friction_y),
        curvature_y=min(tyre.pey1 + tyre.pey2 * change, 1.0),
        change=change,
    )


@inlined
def forces(tyre: MfTyre, loaded: AtLoad, slip_ratio: float, tangent: float, drives: bool) -> tuple[float, float]:
    """Sizes of longitudinal and side force [N] at a slip ratio and a tangent of the slip angle [1], neither negative.

    The slip ratio is over the speed along the wheel; whether the wheel `drives` or brakes decides its sign. Source:
    Pacejka 2012, eqs 4.E9, 4.E19 (pure slip) and 4.E50 to 4.E65 (combined slip).
    """
    signed = slip_ratio if drives else -slip_ratio
    angle = tangent if tyre.takes_tangent == 1.0 else atan(tangent)
    curvature = min(loaded.curvature_x * (1.0 - tyre.pex4 if drives else 1.0 + tyre.pex4), 1.0)
    pure_x = loaded.peak_x * sin(tyre.pcx1 * _bent(loaded.factor_x * slip_ratio, curvature))
    pure_y = loaded.peak_y * sin(tyre.pcy1 * _bent(loaded.factor_y * angle, loaded.curvature_y))
    # cos(atan x) = 1/sqrt(1 + x x)
    side = tyre.rbx2 * slip_ratio
    side_factor = tyre.rbx1 / sqrt(1.0 + side * side)
    weight_x = cos(tyre.rcx1 * _bent(side_factor * angle, min(tyre.rex1 + tyre.rex2 * loaded.change, 1.0)))
    along = tyre.rby2 * angle
    along_factor = tyre.rby1 / sqrt(1.0 + along * along)
    shift = tyre.rhy1 + tyre.rhy2 * loaded.change
    curvature = min(tyre.rey1 + tyre.rey2 * loaded.change, 1.0)
    weight_y = cos(tyre.rcy1 * _bent(along_factor * (signed + shift), curvature))
    if shift != 0.0:
        weight_y /= cos(tyre.rcy1 * _bent(along_factor * shift, curvature))
    return pure_x * weight_x, pure_y * weight_y


@inlined
def _bent(x: float, curvature: float) -> float:
    """atan(x - E (x - atan x)), the argument of the Magic Formula before its shape factor."""
    if curvature != 0.0:
        x -= curvature * (x - atan(x))
    return atan(x)


def cornering_stiffness(tyre: MfTyre, load: float, on_road: Any) -> float:
    """Slope of the side force over the slip angle [N/rad] at zero slip, at a load [N] on a road (`TyreOnRoad`)."""
    loaded = at_load(tyre, load, on_road.c0, on_road.c1)
    return loaded.factor_y * tyre.pcy1 * loaded.peak_y
