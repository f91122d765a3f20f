"""What changes along the way and is no differential equation: the road under the wheels, and where they point to."""

from __future__ import annotations

from math import sqrt

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import BODY_DISTANCE, DISTANCE
from ev_sim.plant.planar.records import GRAVITY
from ev_sim.plant.planar.steering import front_wheels
from ev_sim.surfaces.lookup import interpolate, segment_at


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
    """
    left_start, left_tyre, right_start, right_tyre, slope_distance, grade, side_slope = road
    for i in range(4):
        start, tyre = (left_start, left_tyre) if i % 2 == 0 else (right_start, right_tyre)
        found = segment_at(start, state[DISTANCE + i] + car.wheel_x[i], max(step.segment[i], 0))
        if found != step.segment[i]:
            step.segment[i] = found
            for n in range(6):
                step.tyre[i, n] = tyre[found, n]
    rise, step.slope_segment = interpolate(slope_distance, grade, state[BODY_DISTANCE], step.slope_segment)
    side_rise, _ = interpolate(slope_distance, side_slope, state[BODY_DISTANCE], step.slope_segment)
    step.gravity_z = GRAVITY / sqrt(1.0 + rise * rise + side_rise * side_rise)
    step.gravity_x = -rise * step.gravity_z
    step.gravity_y = -side_rise * step.gravity_z
