"""Free parameters of an identification: of car, plant and sensors, with bounds and scales.

How it works: a name of --free is that of a group, of a parameter, or of an element of an array
(`vehicle.tyre.front_mf.pky1`). Each becomes a `FreeParameter` with the bounds and unit of the
declaration and the start of the car. The search works with numbers over their scales. `changes`
turns points of the search into what differs between the cars of a batch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import entries
from ev_core.vehicle.driveline import AXLES
from ev_core.vehicle.tmeasy import TMEASY_NAMES
from ev_core.vehicle.tyre import MF_NAMES
from ev_msgs_py.refusal import ParameterError, unknown_name

# Arrays, of which single elements may be free, by their names.
_MF = {name: f"vehicle.tyre.{name}_mf" for name in AXLES}
_ELEMENTS = {
    **dict.fromkeys(_MF.values(), MF_NAMES),
    **{f"vehicle.tyre.{name}_tmeasy": TMEASY_NAMES for name in AXLES},
}
# Least and largest coefficients of the Magic Formula that tyres of cars have, wide: their
# declaration knows no ends.
_MF_ENDS = {
    **{
        "pdy1": (0.3, 3.0),
        "pdy2": (-1.0, 0.5),
        "pcy1": (1.0, 2.0),
        "pey1": (-10.0, 1.0),
        "pey2": (-10.0, 10.0),
    },
    **{"pky1": (3.0, 100.0), "pky2": (0.2, 10.0), "rby1": (1.0, 40.0)},
}


# Both axles: a car with different tyres in front and behind has two sets of coefficients.
def _both(*names: str) -> tuple[str, ...]:
    return tuple(f"{_MF[axle]}.{name}" for axle in AXLES for name in names)


GROUPS: Mapping[str, tuple[str, ...]] = {
    "yaw": ("vehicle.yaw_inertia",),
    "tyres": _both("pdy1", "pky1", "pcy1", "pey1"),
    "load": _both("pdy2", "pky2"),
    "roll": ("vehicle.front_roll_share", "vehicle.centre_of_mass_height"),
    "centre": ("vehicle.centre_of_mass_offset",),
    "compliance": tuple(f"vehicle.suspension.{axle}_compliance_steer" for axle in AXLES),
    "lag": ("vehicle.tyre.lateral_stiffness", "plant.load_transfer_lag"),
    "combined": ("plant.imposed_front_braking", *_both("rby1")),
    "steering": ("steering_column.scale", "steering_column.offset", "steering_column.delay"),
    "curve": (
        "vehicle.tyre.coefficients.0",
        "vehicle.tyre.coefficients.1",
        "vehicle.tyre.load_sensitivity",
    ),
}


@dataclass(frozen=True, slots=True)
class FreeParameter:
    """A number that is looked for: `name` is that of a vehicle or ROLE.PARAMETER, `place` that in an array or -1."""

    name: str
    unit: str
    low: float
    high: float
    start: float
    scale: float
    place: int = -1

    @property
    def array(self) -> str:
        """The parameter that holds it."""
        return self.name.rpartition(".")[0] if self.place >= 0 else self.name

    @property
    def is_of_vehicle(self) -> bool:
        """True for a parameter of a vehicle file."""
        return self.name.startswith("vehicle.")


def free_parameters(
    asked: Sequence[str], configurations: Mapping[str, Configuration]
) -> tuple[FreeParameter, ...]:
    """Those of groups and single names, each once.

    Raises ParameterError for one that the graph of the car does not have.

    The scale is the start, where that is 0 a tenth of the range; a range that is wider than a tenth
    to ten times the start is cut to that.
    """
    names = dict.fromkeys(name for each in asked for name in GROUPS.get(each, (each,)))
    # The vehicle is common to all roles, so it is taken from one of them; all else has the role in
    # front.
    known = {
        **{
            f"{role}.{e.name}": e
            for role, c in configurations.items()
            for e in entries(c.parameters)
        },
        **{
            e.name: e
            for e in entries(configurations["plant"].common)
            if e.name.startswith("vehicle.")
        },
    }
    return tuple(_free(name, known) for name in names)


def _free(name: str, known: Mapping[str, Any]) -> FreeParameter:
    array, _, element = name.rpartition(".")
    place, entry = -1, known.get(name)
    if entry is None and array in known and known[array].is_array:
        entry, values = known[array], known[array].default
        # An empty array stands for a car with tyres of another curve, or estimated ones.
        if array in _ELEMENTS and not values:
            allowed = "a car with tyres of curve mf_tyre; of others the group curve"
            if array not in _MF.values():
                allowed = "a car with tyres of curve tmeasy from files"
            raise ParameterError(
                f"--free {name} is refused: the car has no {array}, expected {allowed}"
            )
        names = _ELEMENTS.get(array, tuple(map(str, range(len(values)))))
        if element not in names[: len(values)]:
            raise unknown_name(
                f"element of {array}, which has {len(values)} of them,", element, names
            )
        place = names.index(element)
    if entry is None or entry.type is not float or (entry.is_array and place < 0):
        numbers = [n for n, e in known.items() if e.type is float and not e.is_array]
        raise unknown_name("parameter or group of --free", name, (*GROUPS, *numbers))
    start = float(entry.default[place] if place >= 0 else entry.default)
    low, high, unit = entry.spec.low, entry.spec.high, entry.spec.unit
    if array in _MF.values():
        low, high = _MF_ENDS.get(element, (low, high))
    # None in a declaration is an open end.
    low, high = -np.inf if low is None else low, np.inf if high is None else high
    if start:
        # A tenth and ten times the start, in either order, since a negative start turns them round.
        # An end of the other sign stays: such a parameter may pass zero.
        low, high = max(low, min(0.1 * start, 10.0 * start)) if low * start >= 0 else low, high
        high = min(high, max(0.1 * start, 10.0 * start)) if high * start > 0 else high
    # A start of zero has no magnitude; without finite ends it has no scale either, and is refused
    # below.
    scale = abs(start) or 0.1 * (high - low)
    if not low <= start <= high or not np.isfinite(scale):
        raise ParameterError(
            f"--free {name} starts at {start:g} {unit}, expected {low:g} to {high:g}"
        )
    return FreeParameter(name, unit, low, high, start, scale, place)


def changes(
    free: Sequence[FreeParameter], points: np.ndarray, configurations: Mapping[str, Configuration]
) -> list[dict[str, Any]]:
    """Columns in which cars at some points (n, parameters) differ, by the names of a batch."""
    values = {
        **{f"{role}.{n}": v for role, c in configurations.items() for n, v in c.values().items()},
        **configurations["plant"].values(),
    }
    found = []
    for point in points:
        car: dict[str, Any] = {}
        for each, number in zip(free, point, strict=True):
            # All nodes of a run have the same car, so its parameters change for all of them at
            # once.
            name = f"*.{each.array}" if each.is_of_vehicle else each.array
            if each.place < 0:
                car[name] = float(number)
            else:
                # A batch varies whole arrays: several free elements of one array go into the same
                # copy.
                array = car.setdefault(name, list(values[each.array]))
                array[each.place] = float(number)
        found.append(car)
    return found
