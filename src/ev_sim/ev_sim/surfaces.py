"""Roads by travelled distance: surfaces along each track and the slope, and tyres on surfaces.

How it works: a road has no map. Each wheel has its own travelled distance, and the table of its
side names the surface there; the slope follows the centre of mass. So any manoeuvre meets the same
road at the same distance. What a tyre does on a surface is worked out once for each surface
(`tyre_on_road`), not in each step.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ev_core.law import ParameterError, exp, inlined, parameter, setting
from ev_core.vehicle.tmeasy import tmeasy_tyre
from ev_core.vehicle.tyre import MF_NAMES, OF_LOAD, Tyre, mf_tyres
from ev_msgs_py.refusal import quoted, unknown_name
from ev_sim.tyres import tmeasy
from ev_sim.tyres.curve import (
    FRICTION_CURVES,
    SCALED_BY_FRICTION,
    SLIP_FLOOR,
    Coefficients,
    friction,
    peak,
    peak_slip,
)
from ev_sim.tyres.mf_tyre import MfTyre, at_load, is_plain

REFERENCE = "dry_asphalt"
PATTERNS = ("constant", "segments", "checkerboard", "random")
_FAR = 1e9  # [m], the last segment has no end


@inlined
def segment_at(start: tuple[float, ...], distance: float, previous: int) -> int:
    """Index of the segment that holds a distance [m], searched from the previous one on.

    `start` [m] rises.
    """
    # Both ways, because a car in reverse comes back to segments that it has passed. In a step it
    # moves by one segment at most, so this costs a comparison or two.
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
    # Behind the last point, and before the first one, where `segment_at` gives the first, too.
    if index + 1 >= len(distances) or distance <= distances[index]:
        return values[index], index
    share = (distance - distances[index]) / (distances[index + 1] - distances[index])
    return values[index] + share * (values[index + 1] - values[index]), index


class TyreOnRoad(NamedTuple):
    """A tyre on a surface: coefficients of its curve, f_surface [1] and available friction [1].

    Of a curve in OF_LOAD c0 scales the friction and c1 the slip stiffness.
    """

    c0: float
    c1: float
    c2: float
    c3: float
    rolling_resistance: float
    friction: float


@dataclass(frozen=True, slots=True)
class Surface:
    """One surface: Burckhardt coefficients [1], and the range of its rolling resistance [1]."""

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


# Dissertation, table 2.3 (friction) and table 2.2 (f_surface); the last one is Burckhardt's dry
# asphalt as most textbooks print it (for example Kiencke & Nielsen 2005).
SURFACES = {
    "dry_asphalt": Surface(1.029, 17.16, 0.523),
    "wet_asphalt_1": Surface(0.857, 33.822, 0.347, (0.007, 0.015)),
    "wet_asphalt_2": Surface(0.635, 41.915, 0.289, (0.007, 0.015)),
    "packed_snow_1": Surface(0.425, 51.348, 0.207, (0.056, 0.086)),
    "packed_snow_2": Surface(0.1946, 94.129, 0.0646, (0.056, 0.086)),
    "ice": Surface(0.05, 306.39, 0.0, (0.004, 0.006)),
    "dry_asphalt_burckhardt": Surface(1.2801, 23.99, 0.52),
}


def tyre_on_road(
    tyre: Tyre, surface: str | Surface, rolling_resistance_scale: float = 1.0
) -> TyreOnRoad:
    """A tyre on a surface, one of the table by its name; its f_surface is scaled.

    A Burckhardt tyre takes the coefficients of the surface. The friction of every other tyre is
    scaled by the peak of the surface over that of dry asphalt (an assumption, the sources give such
    tyres for one road only), and a curve in OF_LOAD keeps its slip stiffness by that; a linear tyre
    keeps its slope, and its available friction is that of the surface.
    """
    of = SURFACES[surface] if isinstance(surface, str) else surface
    scale = of.peak_friction / SURFACES[REFERENCE].peak_friction
    rolling_resistance = rolling_resistance_scale * of.rolling_resistance
    curve = tyre.curve
    if curve in OF_LOAD:
        if curve == "mf_tyre":
            largest = tyre.front_mf[MF_NAMES.index("pdx1")]
        else:
            front = tmeasy_tyre(tyre.numbers("front"))
            largest = front.along.fm_pn / front.pn
        return TyreOnRoad(scale, 1.0, 0.0, 0.0, rolling_resistance, scale * largest)
    coefficients = list(tyre.coefficients)
    # The surfaces are Burckhardt's own coefficients.
    if curve == "burckhardt":
        coefficients = [of.c1, of.c2, of.c3, 0.0]
    else:
        for place in SCALED_BY_FRICTION[curve]:
            coefficients[place] *= scale
    c0, c1, c2, c3 = coefficients
    available = of.peak_friction if curve == "linear" else peak(curve, (c0, c1, c2, c3))
    return TyreOnRoad(c0, c1, c2, c3, rolling_resistance, available)


def curve_on_road(tyre: Tyre, surface: str | Surface) -> tuple[Callable[[float], float], float]:
    """Friction use over the slip along the wheel, and the slip of its peak [1], on a surface.

    Of a curve in OF_LOAD it is that of a front tyre at nominal load.
    """
    of = tyre_on_road(tyre, surface)
    curve, c = tyre.curve, Coefficients(*of[:4])
    if curve == "tmeasy":
        front = tmeasy_tyre(tyre.numbers("front"))
        along = tmeasy.at_load(front, front.pn, of.c0, of.c1).along
        return lambda slip: slip * tmeasy.over_slip(along, max(slip, SLIP_FLOOR)), along.peak_slip
    if curve == "mf_tyre":
        tyres = mf_tyres(tyre.front_mf, tyre.rear_mf)
        nominal = tyres.fnomin[0]
        loaded = at_load(MfTyre(tyres, 0, is_plain(tyres)), nominal, of.c0, of.c1)
        curve = "magic_formula"
        c = Coefficients(
            loaded.factor_x, tyres.pcx1[0], loaded.peak_x / nominal, loaded.curvature_x
        )
    return lambda slip: friction(FRICTION_CURVES.index(curve), slip, c), peak_slip(curve, c)


def random_segments(
    generator: np.random.Generator,
    surfaces: tuple[str, ...],
    probability: tuple[float, ...],
    length_range: tuple[float, float],
    distance: float,
) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """Starts [m] and surfaces of segments with uniform lengths, until `distance` is covered.

    `length_range` is the shortest and the longest segment [m]. Lengths do not depend on the
    surface, so `probability` [1] is also each surface's expected share of the distance. The first
    start is 0.
    """
    share = (np.cumsum(probability) / np.sum(probability)).tolist()
    starts, chosen = [0.0], []
    while starts[-1] < distance:
        draw, length = generator.random(), generator.uniform(*length_range)
        chosen.append(surfaces[bisect_right(share, draw)])
        # Lengths are drawn behind surfaces in one stream: their order is part of what a seed means.
        starts.append(starts[-1] + float(length))
    return tuple(starts[:-1]), tuple(chosen)


_KNOWN = f"of the table ({', '.join(SURFACES)}) or of `own`"


@dataclass(frozen=True, slots=True)
class RoadParameters:
    """Surfaces by side and segment, slope by distance; first and last segment go on for ever."""

    pattern: str = setting(
        "constant",
        choices=PATTERNS,
        about="constant: left[0] | right[0]; segments: in order of `length`; checkerboard: sides "
        "swap in each "
        "segment; random: drawn for each side on its own",
    )
    left: tuple[str, ...] = setting(
        ("dry_asphalt",), about=f"surfaces under the left wheels, {_KNOWN}"
    )
    right: tuple[str, ...] = setting(("dry_asphalt",), about="surfaces under the right wheels")
    length: tuple[float, ...] = setting(
        (10.0,),
        unit="m",
        low=0.1,
        high=1e6,
        about="lengths of the segments; the last one given repeats",
    )
    seed: int = setting(
        1, low=0, high=2**31 - 1, about="seed of the random segments; goes with that of the node"
    )
    random_surfaces: tuple[str, ...] = setting(
        ("wet_asphalt_1", "packed_snow_1"), about="surfaces that random segments are drawn from"
    )
    random_probability: tuple[float, ...] = parameter(
        (0.4, 0.6),
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the distance of each random surface",
        source="dissertation, section 2.6: wet asphalt 40 %, packed snow 60 %",
    )
    random_shortest: float = setting(
        5.0, unit="m", low=0.1, high=1e4, about="shortest random segment"
    )
    random_longest: float = setting(
        50.0, unit="m", low=0.1, high=1e4, about="longest random segment"
    )
    random_distance: float = setting(
        5000.0, unit="m", low=1.0, high=1e5, about="distance over which random segments are drawn"
    )
    rolling_resistance_scale: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=10.0,
        about="factor on the rolling resistance that the surfaces add to that of the vehicle; "
        "packed snow has 0.79 to "
        "1.21",
        source="dissertation, table 2.2, of which 1 is the middle",
    )
    slope_distance: tuple[float, ...] = setting(
        (0.0,),
        unit="m",
        low=-1e6,
        high=1e6,
        about="distances of the slope profile, rising; linear in between",
    )
    grade: tuple[float, ...] = setting(
        (0.0,),
        unit="1",
        low=-1.0,
        high=1.0,
        about="rise over run along the road at `slope_distance`, uphill positive",
    )
    side_slope: tuple[float, ...] = setting(
        (0.0,),
        unit="1",
        low=-1.0,
        high=1.0,
        about="rise over run to the left at `slope_distance`",
        lateral=True,
    )
    own: tuple[str, ...] = setting(
        (), about="names of surfaces of your own; one number of each list below for each"
    )
    own_c1: tuple[float, ...] = setting(
        (),
        unit="1",
        low=0.0,
        high=5.0,
        about="friction use = c1 (1 - exp(-c2 slip)) - c3 slip, as Burckhardt has it",
    )
    own_c2: tuple[float, ...] = setting((), unit="1", low=1.0, high=1000.0, about="c2 of the same")
    own_c3: tuple[float, ...] = setting((), unit="1", low=0.0, high=5.0, about="c3 of the same")
    own_rolling_resistance: tuple[float, ...] = setting(
        (),
        unit="1",
        low=0.0,
        high=1.0,
        about="rolling resistance coefficient that the surface adds to that of the car",
    )

    def __post_init__(self) -> None:
        if not (self.left and self.right and self.length):
            raise ParameterError("left, right and length need at least one element each")
        if (
            len(self.random_surfaces) != len(self.random_probability)
            or sum(self.random_probability) <= 0.0
        ):
            raise ParameterError(
                "random_probability needs one share for each of random_surfaces, not all of them "
                "zero"
            )
        if self.random_shortest > self.random_longest:
            raise ParameterError("random_shortest is above random_longest")
        if not 0 < len(self.slope_distance) == len(self.grade) == len(self.side_slope):
            raise ParameterError(
                "slope_distance, grade and side_slope need the same number of elements, at least "
                "one"
            )
        if any(b <= a for a, b in zip(self.slope_distance, self.slope_distance[1:], strict=False)):
            raise ParameterError("slope_distance must rise")
        self._check_surfaces()

    def _check_surfaces(self) -> None:
        numbers = (self.own_c1, self.own_c2, self.own_c3, self.own_rolling_resistance)
        if any(len(each) != len(self.own) for each in numbers):
            raise ParameterError(
                "own_c1, own_c2, own_c3 and own_rolling_resistance need one number for each of own"
            )
        for i, name in enumerate(self.own):
            if name in SURFACES or name in self.own[:i]:
                raise ParameterError(
                    f"own {quoted(name)} is refused: there is such a surface, expected another name"
                )
            if self.own_c1[i] * (1.0 - exp(-self.own_c2[i])) - self.own_c3[i] <= 0.0:
                raise ParameterError(
                    f"own {quoted(name)} has no friction at a slip of 1, expected a smaller c3"
                )
        known = (*SURFACES, *self.own)
        for where in ("left", "right", "random_surfaces"):
            for name in getattr(self, where):
                if name not in known:
                    raise ParameterError(f"{where}: {unknown_name('surface', name, known)}")

    @property
    def is_random(self) -> bool:
        """True if the seed matters."""
        return self.pattern == "random"

    def surface(self, name: str) -> Surface:
        """The surface of the table or of one's own with this name."""
        if name in SURFACES:
            return SURFACES[name]
        i = self.own.index(name)
        rolling = self.own_rolling_resistance[i]
        return Surface(self.own_c1[i], self.own_c2[i], self.own_c3[i], (rolling, rolling))


@dataclass(frozen=True, slots=True)
class Segments:
    """Surfaces along one track: surface[n] lies from start[n] to start[n + 1] [m]."""

    start: tuple[float, ...]
    surface: tuple[str, ...]

    def at(self, distance: float) -> str:
        """The surface at a distance [m]."""
        return self.surface[max(int(np.searchsorted(self.start, distance, side="right")) - 1, 0)]


def left_and_right(road: RoadParameters) -> tuple[Segments, Segments]:
    """The segments under the left and under the right wheels."""
    if road.pattern == "constant":
        # From far behind the start: a car may roll back.
        return Segments((-_FAR,), road.left[:1]), Segments((-_FAR,), road.right[:1])
    if road.pattern == "segments":
        return _in_order(road.left, road.length), _in_order(road.right, road.length)
    if road.pattern == "checkerboard":
        # As long as a random road would be; behind it the last surface goes on.
        repeats = int(road.random_distance / road.length[0]) + 1
        pair = (road.left[0], road.right[0])
        left = tuple(pair[n % 2] for n in range(repeats))
        right = tuple(pair[(n + 1) % 2] for n in range(repeats))
        return _in_order(left, road.length[:1]), _in_order(right, road.length[:1])
    drawn = (
        road.random_surfaces,
        road.random_probability,
        (road.random_shortest, road.random_longest),
        road.random_distance,
    )
    # Each side has a stream of its own: more segments on one do not change the other.
    left_side, right_side = (
        random_segments(np.random.default_rng((road.seed, side)), *drawn) for side in (0, 1)
    )
    return Segments(*left_side), Segments(*right_side)


def _in_order(surfaces: tuple[str, ...], length: tuple[float, ...]) -> Segments:
    # The last segment needs no length, it has no end.
    lengths = [length[min(n, len(length) - 1)] for n in range(len(surfaces) - 1)]
    return Segments((-_FAR, *(float(end) for end in np.cumsum(lengths))), surfaces)
