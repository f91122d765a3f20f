"""Tyres by TMeasy: their numbers at two loads, and those estimated from size and load index.

Source: G. Rill, Road Vehicle Dynamics: Fundamentals and Modeling, 2012, and with A. A. Castro,
2nd ed. 2020, chapter on the tyre.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from ev_core.elementary import exp
from ev_core.parameters.record import entry, part
from ev_msgs_py.compilable import inlined
from ev_msgs_py.refusal import ParameterError, quoted

# Load over the nominal one up to which the numbers at two loads are continued; beyond it friction
# and slips over load stay. An assumption: Rill gives none, others end at 3.5 or 4.
LARGEST_LOAD = 3.0
_LN_10 = 2.302585092994046
_GRAVITY = 9.81  # [m/s^2], as `car.GRAVITY`; that module imports this one
_OF_A_CURVE = ("df{}0", "s{}m", "f{}m", "s{}s", "f{}s")
_SIZE = re.compile(r"(\d{3})/(\d{2}) ?Z?R ?(\d{2}) (\d{2,3})[A-Z]?")
# By number of a curve at the nominal load and at twice that: a slip, or a force over the load.
# Pattern of passenger car tyres of ChTMeasyTire::GuessPassCar70Par, Project Chrono (BSD-3-Clause),
# which has it from data that Pacejka prints; nominal load is half of the largest.
_ALONG = (
    (18.3741, 19.4669),
    (0.13913, 0.13913),
    (1.1292, 1.0896),
    (0.66667, 0.66667),
    (0.80149, 0.76917),
)
_ACROSS = (
    (15.9826, 12.8509),
    (0.14852, 0.18504),
    (1.0009, 0.91367),
    (0.96524, 1.0714),
    (0.8336, 0.77336),
)


@dataclass(slots=True)
class TmeasyCurve:
    """One force over its slip, at the nominal load P_N and at twice that."""

    df0_pn: float = entry(80e3, unit="N", about="initial slope")
    df0_p2n: float = entry(150e3, unit="N", about="initial slope")
    sm_pn: float = entry(0.12, unit="1", about="slip of the largest force")
    sm_p2n: float = entry(0.14, unit="1", about="slip of the largest force")
    fm_pn: float = entry(4e3, unit="N", about="largest force")
    fm_p2n: float = entry(7.5e3, unit="N", about="largest force")
    ss_pn: float = entry(0.5, unit="1", about="slip from which on all of the contact slides")
    ss_p2n: float = entry(0.6, unit="1", about="slip from which on all of the contact slides")
    fs_pn: float = entry(3.5e3, unit="N", about="force of the sliding contact")
    fs_p2n: float = entry(6.5e3, unit="N", about="force of the sliding contact")


@dataclass(slots=True)
class TmeasyTyre:
    """An upright tyre of TMeasy, alike to both sides."""

    pn: float = entry(4e3, unit="N", about="nominal load")
    along: TmeasyCurve = part(TmeasyCurve)
    across: TmeasyCurve = part(TmeasyCurve)


# As in a file, in the order of the record.
TMEASY_NAMES = (
    "pn",
    *(f"{of.format(axis)}_{at}" for axis, of, at in product("xy", _OF_A_CURVE, ("pn", "p2n"))),
)
_PER_CURVE = (len(TMEASY_NAMES) - 1) // 2


def tmeasy_tyre(numbers: Sequence[float]) -> TmeasyTyre:
    """The tyre of numbers in the order of TMEASY_NAMES; that of the record without numbers."""
    if not numbers:
        return TmeasyTyre()
    nominal, *curves = numbers
    return TmeasyTyre(nominal, TmeasyCurve(*curves[:_PER_CURVE]), TmeasyCurve(*curves[_PER_CURVE:]))


def refuse_tmeasy(axle: str, numbers: Sequence[float]) -> None:
    """Refuse numbers of an axle's tyre that give no curve at some load up to LARGEST_LOAD."""
    if len(numbers) != len(TMEASY_NAMES):
        raise ParameterError(
            f"curve tmeasy needs {axle}_file, estimated_from, or {axle}_tmeasy with "
            f"{len(TMEASY_NAMES)} elements, not {len(numbers)}"
        )
    of = dict(zip(TMEASY_NAMES, numbers, strict=True))

    def refuse(name: str, expected: str) -> None:
        text = f"{name.upper()} of the {axle} tyres is {of[name]:g}, expected {expected}"
        raise ParameterError(text)

    for name, value in of.items():
        if value <= 0.0:
            refuse(name, "above 0")
    for axis in "xy":
        # Forces over load are a line over the load, which keeps its sign between these ends.
        for force in (f"df{axis}0", f"f{axis}m", f"f{axis}s"):
            least = of[f"{force}_pn"]
            if not least < of[f"{force}_p2n"] < 4.0 * least:
                refuse(f"{force}_p2n", f"above {least:g} and below {4.0 * least:g}")
        for load in ("pn", "p2n"):
            slope = 2.0 * of[f"f{axis}m_{load}"] / of[f"s{axis}m_{load}"]
            # Otherwise the rising part would pass the peak before its slip.
            if of[f"df{axis}0_{load}"] < slope:
                refuse(f"df{axis}0_{load}", f"2 F_M/s_M or more, {slope:g}")
            if of[f"f{axis}s_{load}"] > of[f"f{axis}m_{load}"]:
                refuse(f"f{axis}s_{load}", f"at most F_M, {of[f'f{axis}m_{load}']:g}")
        # Slips are lines over the load, so its ends decide.
        for share in (0.0, LARGEST_LOAD):
            peak = linear(of[f"s{axis}m_pn"], of[f"s{axis}m_p2n"], share)
            full = linear(of[f"s{axis}s_pn"], of[f"s{axis}s_p2n"], share)
            if not 0.0 < peak < full:
                refuse(
                    f"s{axis}m_p2n",
                    f"slips that give 0 < s_M < s_S at {share:g} times the nominal load, not "
                    f"s_M {peak:g} and s_S {full:g}",
                )


@inlined
def linear(at_nominal: float, at_double: float, share: float) -> float:
    """A slip [1] at a load over the nominal one, from those at once and twice that load."""
    return at_nominal + (at_double - at_nominal) * (share - 1.0)


class TyreSize(NamedTuple):
    """Size and load index, as they stand on the side wall of a tyre."""

    width: float  # [m]
    aspect: float  # height over width [1]
    rim: float  # diameter [m]
    load_index: int

    @property
    def largest_load(self) -> float:
        """Load that the index stands for [N]: 45 kg times 10^(index/80).

        The table of the ETRTO Standards Manual is this geometric series, rounded: they differ by
        less than 2 % from index 60 to 126.
        """
        return 45.0 * exp(_LN_10 * self.load_index / 80.0) * _GRAVITY

    @property
    def rolling_radius(self) -> float:
        """Radius at the nominal load [m]: (2 r_0 + r_static)/3, Rill's of a tyre that is stiff.

        It gives way by 16 % of the height of its side wall at its largest load, and by half of that
        at the nominal one: rule of ChTMeasyTire, Project Chrono (BSD-3-Clause).
        """
        side_wall = self.aspect * self.width
        return side_wall + 0.5 * self.rim - 0.08 * side_wall / 3.0


def tyre_size(text: str) -> TyreSize:
    """Size and load index of a text such as 205/55R16 91V; ParameterError if it is none."""
    found = _SIZE.fullmatch(text.strip().upper())
    if not found or not 60 <= int(found[4]) <= 126:
        raise ParameterError(
            f"estimated_from is {quoted(text)}, expected the size and the load index (60 to 126) "
            "of a passenger car tyre, such as '205/55R16 91V'"
        )
    width, aspect, rim, load_index = (int(number) for number in found.groups())
    return TyreSize(width / 1e3, aspect / 100.0, rim * 0.0254, load_index)


def estimated_tmeasy(text: str) -> tuple[float, ...]:
    """Numbers in the order of TMEASY_NAMES of a passenger car tyre, from its size and load index.

    An estimate, for cars without measured tyres; dry asphalt.
    """
    nominal = 0.5 * tyre_size(text).largest_load
    numbers = [nominal]
    for n, (once, twice) in enumerate((*_ALONG, *_ACROSS)):
        is_slip = n % len(_ALONG) in (1, 3)
        numbers += [once, twice] if is_slip else [once * nominal, twice * 2.0 * nominal]
    return tuple(numbers)
