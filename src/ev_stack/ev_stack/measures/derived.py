"""Terms of expressions besides channels and metrics: series of motion, parameters of the car."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_core.parameters.declaration import flatten
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured
from ev_stack.measures.named import DrivenRun

VEHICLE = "vehicle."  # begins the names of parameters of the car
_TWIST = "twist."
# What `motion.lateral_acceleration_on_path` reads.
_ON_PATH = (_TWIST, "imu.longitudinal_acceleration", motion.LATERAL_ACCELERATION)


class Derived(NamedTuple):
    """A series (n,) that follows from channels; `needs` are the beginnings of their names."""

    unit: str
    formula: str
    of: Callable[[DrivenRun], np.ndarray]
    needs: tuple[str, ...]


SERIES: Mapping[str, Derived] = {
    "path_speed": Derived(
        "m/s",
        "V along the path, negative backwards",
        lambda run: motion.path_speed(run.signals),
        (_TWIST,),
    ),
    "path_acceleration": Derived(
        "m/s^2",
        "a_y cos(beta) - a_x sin(beta), across the path",
        lambda run: motion.lateral_acceleration_on_path(run.signals),
        _ON_PATH,
    ),
    "path_radius": Derived(
        "m",
        "V^2 over that, infinite straight ahead",
        lambda run: motion.radius_of_path(run.signals),
        _ON_PATH,
    ),
    "sideslip_angle": Derived(
        "rad", "beta", lambda run: motion.sideslip_angle(run.signals), (_TWIST,)
    ),
    "total_drive_torque": Derived(
        "N m",
        "sum of the drive torques at the wheels",
        lambda run: motion.total_drive_torque(run.signals),
        ("wheel_states.effort.",),
    ),
}


def of_vehicle(name: str, place: int | None) -> Callable[[DrivenRun], float]:
    """Build the function that reads a number of the car by its dotted name, or by name and place.

    ParameterError if no car has it, or if it is a list and no place is given, or the other way
    round.
    """
    known = _parameters()
    if name not in known:
        raise unknown_name("vehicle parameter", name, known)
    is_list = isinstance(known[name], tuple)
    values = known[name] if is_list else (known[name],)
    is_text = any(isinstance(each, str) for each in values)
    if is_list and place is None and not is_text:
        raise ParameterError(
            f"{VEHICLE}{name} is a list, expected one of its numbers, such as {VEHICLE}{name}[0]"
        )
    if is_text or (place is not None and not is_list):
        raise ParameterError(
            f"{VEHICLE}{name} is refused, expected a number, or a list with the place of one,"
            " as [0]"
        )
    read = operator.attrgetter(name)

    def number(run: DrivenRun) -> float:
        found = read(run.vehicle)
        if place is None:
            # As numpy's: a division by zero is then infinite instead of an error, as with channels.
            return np.float64(found)
        # How many numbers a list has differs from car to car.
        if place >= len(found):
            raise NotMeasured(f"{VEHICLE}{name} of this car has {len(found)} numbers")
        return np.float64(found[place])

    return number


@cache
def _parameters() -> Mapping[str, Any]:
    """The parameters of a car by name, and what its description computes from them."""
    # Any car will do: all have the same names, and which are lists does not depend on the car.
    car = Vehicle()
    computed = {
        name: getattr(car, name) for name, of in vars(Vehicle).items() if isinstance(of, property)
    }
    return {**flatten(car), **computed}
