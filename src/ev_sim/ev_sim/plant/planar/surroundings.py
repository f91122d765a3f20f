"""What changes along the way and is no differential equation: the road under the wheels, and where they point to."""

from __future__ import annotations

from math import sqrt

import numpy as np

from ev_msgs_py.vehicle import Vehicle
from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import BODY_DISTANCE, DISTANCE
from ev_sim.plant.planar.records import GRAVITY
from ev_sim.plant.planar.steering import front_wheels
from ev_sim.surfaces.lookup import interpolate, segment_at
from ev_sim.surfaces.road import RoadParameters, Segments, left_and_right
from ev_sim.surfaces.table import coefficients


@compiled
def steer(car, step, angle: float) -> None:
    """Set the direction of the front wheels from the mean road-wheel angle [rad]; the rear wheels stay straight."""
    cos_left, sin_left, cos_right, sin_right = front_wheels(
        angle, car.wheelbase, car.front_track, car.parallel_steering
    )
    step.cos_steer[0], step.sin_steer[0] = cos_left, sin_left
    step.cos_steer[1], step.sin_steer[1] = cos_right, sin_right


@compiled
def find_road(state: np.ndarray, car, step, road) -> None:
    """Set the tyre coefficients under each wheel and the slope under the centre of mass.

    Every wheel looks at its own travelled distance, ahead of or behind the centre of mass by its place in the car.
    `road` is what `road_tables` gives.
    """
    left, right, slope = road
    for i in range(4):
        track = left if i % 2 == 0 else right
        found = segment_at(track[0], state[DISTANCE + i] + car.wheel_x[i], max(step.segment[i], 0))
        if found != step.segment[i]:
            step.segment[i] = found
            for n in range(6):
                step.tyre[i, n] = track[1 + n, found]
    rise, step.slope_segment = interpolate(slope[0], slope[1], state[BODY_DISTANCE], step.slope_segment)
    side_rise, _ = interpolate(slope[0], slope[2], state[BODY_DISTANCE], step.slope_segment)
    step.gravity_z = GRAVITY / sqrt(1.0 + rise * rise + side_rise * side_rise)
    step.gravity_x = -rise * step.gravity_z
    step.gravity_y = -side_rise * step.gravity_z


def road_tables(road: RoadParameters, vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The road for this vehicle's tyres, in three arrays that compiled code looks up.

    Left and right: distances at which segments begin [m], and for each the six numbers of `step.tyre`, of shape
    (7, segments). Slope: distances [m], grade and side slope [1] there, of shape (3, points).
    """
    left, right = left_and_right(road)
    slope = np.array((road.slope_distance, road.grade, road.side_slope))
    scale = road.rolling_resistance_scale
    return _track_table(left, vehicle, scale), _track_table(right, vehicle, scale), slope


def _track_table(segments: Segments, vehicle: Vehicle, scale: float) -> np.ndarray:
    tyre = vehicle.tyre
    of = {name: coefficients(tyre.curve, tyre.coefficients, name, scale) for name in set(segments.surface)}
    return np.array([(start, *of[name]) for start, name in zip(segments.start, segments.surface, strict=True)]).T.copy()
