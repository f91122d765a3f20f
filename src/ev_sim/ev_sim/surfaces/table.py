"""The surfaces that a road is made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.vehicle.tyre import MF_NAMES, Tyre, mf_tyres
from ev_msgs_py.compilable import inlined
from ev_sim.tyres.curve import Coefficients, peak
from ev_sim.tyres.mf_tyre import at_load, is_plain


@inlined
def segment_at(start: tuple[float, ...], distance: float, previous: int) -> int:
    """Index of the segment that holds a distance [m], looked for from the previous one on; `start` [m] rises."""
    index = previous
    while index + 1 < len(start) and distance >= start[index + 1]:
        index += 1
    while index > 0 and distance < start[index]:
        index -= 1
    return index


@inlined
def interpolate(
    distances: tuple[float, ...], values: tuple[float, ...], distance: float, previous: int
) -> tuple[float, int]:
    """Linear interpolation between points, constant outside, and the index of the point before."""
    index = segment_at(distances, distance, previous)
    if index + 1 >= len(distances) or distance <= distances[index]:
        return values[index], index
    share = (distance - distances[index]) / (distances[index + 1] - distances[index])
    return values[index] + share * (values[index + 1] - values[index]), index


class TyreOnRoad(NamedTuple):
    """A tyre on a surface: the coefficients of its curve, f_surface [1] and its available friction [1].

    Of an mf_tyre c0 scales the friction and c1 the slip stiffness.
    """

    c0: float
    c1: float
    c2: float
    c3: float
    rolling_resistance: float
    friction: float


@dataclass(frozen=True, slots=True)
class Surface:
    """One surface: Burckhardt coefficients [1] and the range of its part of the rolling resistance coefficient [1]."""

    c1: float
    c2: float
    c3: float
    rolling_resistance_range: tuple[float, float] = (0.0, 0.0)

    @property
    def rolling_resistance(self) -> float:
        """The middle of the range [1]."""
        least, largest = self.rolling_resistance_range
        return (least + largest) / 2

    @property
    def peak_friction(self) -> float:
        """The largest friction use of a Burckhardt tyre up to full slip [1]."""
        return peak("burckhardt", (self.c1, self.c2, self.c3, 0.0))


# Dissertation, table 2.3 (friction) and table 2.2 (f_surface); the last one is Burckhardt's dry asphalt as most
# textbooks print it (for example Kiencke & Nielsen 2005).
SURFACES = {
    "dry_asphalt": Surface(1.029, 17.16, 0.523),
    "wet_asphalt_1": Surface(0.857, 33.822, 0.347, (0.007, 0.015)),
    "wet_asphalt_2": Surface(0.635, 41.915, 0.289, (0.007, 0.015)),
    "packed_snow_1": Surface(0.425, 51.348, 0.207, (0.056, 0.086)),
    "packed_snow_2": Surface(0.1946, 94.129, 0.0646, (0.056, 0.086)),
    "ice": Surface(0.05, 306.39, 0.0, (0.004, 0.006)),
    "dry_asphalt_burckhardt": Surface(1.2801, 23.99, 0.52),
}
REFERENCE = "dry_asphalt"


def tyre_on_road(tyre: Tyre, surface: str | Surface, rolling_resistance_scale: float = 1.0) -> TyreOnRoad:
    """A tyre on a surface, one of the table by its name, whose f_surface is scaled.

    A Burckhardt tyre takes the coefficients of the surface. The friction of every other tyre is scaled by the peak of
    the surface over that of dry asphalt (an assumption, the sources give such tyres for one road only), and an mf_tyre
    keeps its slip stiffness by that; a linear tyre keeps its slope, and its available friction is that of the surface.
    """
    of = SURFACES[surface] if isinstance(surface, str) else surface
    curve, (c0, c1, c2, c3) = tyre.curve, tyre.coefficients
    scale = of.peak_friction / SURFACES[REFERENCE].peak_friction
    rolling_resistance = rolling_resistance_scale * of.rolling_resistance
    if curve == "mf_tyre":
        return TyreOnRoad(scale, 1.0, 0.0, 0.0, rolling_resistance, scale * tyre.front_mf[MF_NAMES.index("pdx1")])
    if curve == "burckhardt":
        c0, c1, c2, c3 = of.c1, of.c2, of.c3, 0.0
    elif curve in ("rational", "two_exponential"):
        c0 *= scale
    elif curve == "magic_formula":
        c2 *= scale
    available = of.peak_friction if curve == "linear" else peak(curve, (c0, c1, c2, c3))
    return TyreOnRoad(c0, c1, c2, c3, rolling_resistance, available)


def curve_on_road(tyre: Tyre, surface: str | Surface) -> tuple[str, Coefficients]:
    """The friction curve of a tyre on a surface, as `tyres.curve` has it; that of a front mf_tyre at nominal load."""
    of = tyre_on_road(tyre, surface)
    if tyre.curve != "mf_tyre":
        return tyre.curve, Coefficients(*of[:4])
    tyres = mf_tyres(tyre.front_mf, tyre.rear_mf)
    nominal = tyres.fnomin[0]
    loaded = at_load(tyres, 0, nominal, of.c0, of.c1, is_plain(tyres))
    return "magic_formula", Coefficients(loaded.factor_x, tyres.pcx1[0], loaded.peak_x / nominal, loaded.curvature_x)
