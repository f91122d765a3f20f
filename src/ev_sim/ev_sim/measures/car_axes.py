"""Wheel directions, and tyre forces in the axes of the car instead of those of the wheel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ev_core.vehicle.car import front_wheel_tangents
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.measures import motion
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording


class Direction(NamedTuple):
    """Cosine and sine of a wheel's angle against the car, (n,) [1]."""

    cosine: np.ndarray
    sine: np.ndarray


class Force(NamedTuple):
    """Force of the road on a tyre to the front and to the left of the car, (n,) [N]."""

    x: np.ndarray
    y: np.ndarray


def wheel_directions(run: Recording, vehicle: Vehicle) -> Mapping[str, Direction]:
    """Where each wheel points, by the vehicle's steering geometry and what turns its rear wheels."""
    mean = channel(run, motion.ROAD_WHEEL_ANGLE)
    apart = run.channels.get("rear_steering.state.angle", 0.0)
    angle, rear = np.tan(mean), np.tan(vehicle.rear_steering_ratio * mean + apart)
    parallel = float(vehicle.steering_geometry == "parallel")
    tangents = (*front_wheel_tangents(angle, vehicle.wheelbase, vehicle.front_track, parallel), rear, rear)
    cosines = (1 / np.hypot(1.0, tangent) for tangent in tangents)
    return {
        wheel: Direction(cosine, tangent * cosine)
        for wheel, tangent, cosine in zip(WHEEL_NAMES, tangents, cosines, strict=True)
    }


def tyre_force(run: Recording, wheel: str, vehicle: Vehicle) -> Force:
    """F_x = F_p cos d - F_b sin d, F_y = F_p sin d + F_b cos d of a wheel (Tatar & Chudzik, eq 4)."""
    along, across = (channel(run, f"tire_forces.{kind}_force.{wheel}") for kind in ("longitudinal", "lateral"))
    cosine, sine = wheel_directions(run, vehicle)[wheel]
    return Force(along * cosine - across * sine, along * sine + across * cosine)
