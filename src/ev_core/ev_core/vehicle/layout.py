"""What a method needs of a vehicle's layout, as declarations that are checked before anything is made."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import couplings, has_equal_motors, single_wheels
from ev_msgs_py.contract.wheels import WHEEL_NAMES

# Says what a method with these parameters needs and this vehicle lacks; an empty text if there is nothing.
Need = Callable[[Any, Vehicle], str]


def driven(*needed: str) -> Need:
    """These wheels must be among the driven ones, each with a torque of its own."""

    def lacks(_parameters: Any, vehicle: Vehicle) -> str:
        if not set(needed) <= set(vehicle.driven_wheels):
            return f"{listed(needed)} among the driven wheels"
        return "" if set(needed) <= set(single_wheels(vehicle)) else f"a motor or a clutch for each of {listed(needed)}"

    return lacks


def only_driven(*needed: str) -> Need:
    """These wheels must be the driven ones."""

    def lacks(_parameters: Any, vehicle: Vehicle) -> str:
        return "" if set(needed) == set(vehicle.driven_wheels) else f"{listed(needed)} as the only driven wheels"

    return lacks


def any_driven(_parameters: Any, vehicle: Vehicle) -> str:
    """At least one wheel must be driven."""
    return "" if vehicle.driven_wheels else "at least one driven wheel"


def each_driven(_parameters: Any, vehicle: Vehicle) -> str:
    """At least one wheel must be driven, and all that are must have a torque of their own."""
    if single_wheels(vehicle) != vehicle.driven_wheels:
        return "a motor or a clutch for each driven wheel"
    return any_driven(_parameters, vehicle)


def equal_motors(_parameters: Any, vehicle: Vehicle) -> str:
    """All driven wheels must have the same motor and gear."""
    return "" if has_equal_motors(vehicle) else "equal motors and gears at all driven wheels, and no engine"


FRONT_WHEELS_DRIVEN = driven("front_left", "front_right")
REAR_WHEELS_DRIVEN = driven("rear_left", "rear_right")
ALL_WHEELS_DRIVEN = driven(*WHEEL_NAMES)


def listed(names: tuple[str, ...]) -> str:
    """Names in one phrase."""
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]


def refusal(role: str, method: str, needs: tuple[Need, ...], parameters: Any, vehicle: Vehicle) -> str:
    """The line that refuses a layout, empty if it suits."""
    for need in needs:
        lacking = need(parameters, vehicle)
        if lacking:
            drives = ", ".join(vehicle.driven_wheels) or "none"
            how = f" with {' and '.join(couplings(vehicle))}" if single_wheels(vehicle) != vehicle.driven_wheels else ""
            return f"{role} method {method} needs {lacking}, vehicle {vehicle.name} drives {drives}{how}"
    return ""
