"""The fused loop: many steps of the whole plant in one compiled call."""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import BODY_DISTANCE, DISTANCE, HEADING, VX, VY, WHEEL_ANGLE
from ev_sim.plant.planar.integrator import integrate
from ev_sim.plant.planar.powertrain import account, apply_drives
from ev_sim.plant.planar.records import GRAVITY
from ev_sim.plant.planar.state import index
from ev_sim.plant.planar.steering import front_wheels
from ev_sim.surfaces.lookup import interpolate, segment_at

X = index("x")
Y = index("y")


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


@compiled
def run(
    state: np.ndarray,
    car_record: np.ndarray,
    step_record: np.ndarray,
    road,
    maps,
    voltages: np.ndarray,
    lags,
    drives: np.ndarray,
    drive_parameters: np.ndarray,
    h: float,
    steps: int,
    stage: np.ndarray,
    slopes: np.ndarray,
    work: np.ndarray,
) -> None:
    """Advance the plant in place by a number of steps of h [s] under the command in `step_record`.

    The steering angle goes on at its commanded rate, the torque commands are held.
    """
    car, step = car_record[0], step_record[0]
    brushless = (drives, drive_parameters)  # in a tuple from outside they would cost more than a step does
    turned = work[4]
    for i in range(4):
        step.mean_drive[i] = 0.0
    for n in range(steps):
        find_road(state, car, step, road)
        steer(car, step, step.steering_angle + step.steering_rate * ((n + 0.5) * h))
        apply_drives(state, car, step, maps, voltages, lags, brushless, h, work)
        vx, vy, heading = state[VX], state[VY], state[HEADING]
        for i in range(4):
            turned[i] = -state[WHEEL_ANGLE + i]
        integrate(state, car, step, h, stage, slopes)
        for i in range(4):
            turned[i] += state[WHEEL_ANGLE + i]
            step.mean_drive[i] += step.drive[i] / steps
        # The position feeds nothing back, so the trapezoidal rule over the step is enough.
        mean_x, mean_y = 0.5 * (vx + state[VX]), 0.5 * (vy + state[VY])
        middle = 0.5 * (heading + state[HEADING])
        cosine, sine = cos(middle), sin(middle)
        state[X] += h * (mean_x * cosine - mean_y * sine)
        state[Y] += h * (mean_y * cosine + mean_x * sine)
        account(state, car, step, maps, voltages, brushless, turned, h, work)
