"""What the car seen from above needs beyond the recorded channels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.car import GRAVITY
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.metric import NotMeasured
from ev_sim.report.quantities.car_axes import wheel_directions
from ev_sim.report.quantities.motion import heading
from ev_sim.running.recording.recording import Recording

PREFIX = "view."


def view_channels(run: Recording, vehicle: Vehicle) -> dict[str, np.ndarray]:
    """Heading and angle of each wheel against the car, (n,) [rad], as far as the run holds what they follow from."""

    def angles() -> dict[str, np.ndarray]:
        directions = wheel_directions(run, vehicle)
        return {f"{PREFIX}wheel_angle.{wheel}": np.arctan2(at.sine, at.cosine) for wheel, at in directions.items()}

    return {**_if_recorded(lambda: {f"{PREFIX}heading": heading(run)}), **_if_recorded(angles)}


def car_of(vehicle: Vehicle) -> dict[str, Any]:
    """Geometry of the car about its centre of mass [m], x forward, y left, and the mean wheel load [N]."""
    front = vehicle.wheelbase - vehicle.centre_of_mass_to_rear_axle
    rear = -vehicle.centre_of_mass_to_rear_axle
    offset = vehicle.centre_of_mass_offset
    places = [
        [x, side * track / 2 - offset]
        for x, track in ((front, vehicle.front_track), (rear, vehicle.rear_track))
        for side in (1, -1)
    ]
    return {
        "name": vehicle.name,
        "wheels": [{"name": name.replace("_", " "), "place": at} for name, at in zip(WHEEL_NAMES, places, strict=True)],
        "radius": vehicle.wheel_radius,
        "load": vehicle.mass * GRAVITY / len(WHEEL_NAMES),
    }


def _if_recorded(measure: Callable[[], dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    try:
        return measure()
    except NotMeasured:
        return {}
