"""Geometry of a car about its centre of mass, and the angles that a view derives from channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.parameters.values import build
from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.handling import wheel_directions
from ev_stack.measures.metric import NotMeasured
from ev_stack.measures.motion import heading, roll_angle
from ev_stack.recording.recording import Recording

PREFIX = "view."
_VEHICLE = "vehicle."  # what the names of its parameters begin with


@dataclass(frozen=True, slots=True)
class Wheel:
    """Centre of a wheel from the centre of mass, x forward and y left, and its radius [m]."""

    name: str
    x: float
    y: float
    radius: float


def vehicle_in(parameters: Mapping[str, Any]) -> Vehicle:
    """Build the car that parameters of a plant describe; ParameterError if they describe none."""
    of_car = {name: value for name, value in parameters.items() if name.startswith(_VEHICLE)}
    return build(Vehicle, of_car, _VEHICLE)


def wheels_of(vehicle: Vehicle) -> list[Wheel]:
    """The wheels of a car, each with its true radius."""
    front = vehicle.wheelbase - vehicle.centre_of_mass_to_rear_axle
    rear = -vehicle.centre_of_mass_to_rear_axle
    places = [
        # The offset is that of the centre of mass to the left, from which places count.
        (x, side * track / 2 - vehicle.centre_of_mass_offset)
        for x, track in ((front, vehicle.front_track), (rear, vehicle.rear_track))
        for side in (1, -1)
    ]
    return [
        Wheel(name, *place, vehicle.wheel_radius * ratio)
        for name, place, ratio in zip(WHEEL_NAMES, places, vehicle.wheel_radius_ratio, strict=True)
    ]


def car_of(vehicle: Vehicle) -> dict[str, Any]:
    """The same for a page, with one radius for all wheels, and the mean wheel load [N]."""
    return {
        "name": vehicle.name,
        "wheels": [
            {"name": each.name.replace("_", " "), "place": [each.x, each.y]}
            for each in wheels_of(vehicle)
        ],
        "radius": vehicle.wheel_radius,
        "load": mean_load(vehicle),
    }


def mean_load(vehicle: Vehicle) -> float:
    """Weight of the car over its number of wheels [N]."""
    return vehicle.mass * GRAVITY / len(WHEEL_NAMES)


def view_channels(run: Recording, vehicle: Vehicle) -> dict[str, np.ndarray]:
    """Heading, roll, and angle of each wheel against the car, (n,) [rad], as far as recorded."""

    def angles() -> dict[str, np.ndarray]:
        directions = wheel_directions(run, vehicle)
        return {
            f"{PREFIX}wheel_angle.{wheel}": np.arctan2(at.sine, at.cosine)
            for wheel, at in directions.items()
        }

    # Each on its own: a run without steering still has a heading.
    return {
        **_if_recorded(lambda: {f"{PREFIX}heading": heading(run)}),
        **_if_recorded(lambda: {f"{PREFIX}roll": roll_angle(run)}),
        **_if_recorded(angles),
    }


def _if_recorded(measure: Callable[[], dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    try:
        return measure()
    except NotMeasured:
        return {}
