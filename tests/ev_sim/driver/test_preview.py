"""The driver with preview: every car settles at every speed and follows bends, mirrored alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driver.preview_drives import drives, from_circle
from scipy.linalg import expm, solve_discrete_are

from ev_core.vehicle.description import Vehicle
from ev_sim.driver.preview_gains import (
    GAIN_SPEEDS,
    HEADING_ERROR,
    LATERAL_ERROR,
    POINT_STEP,
    STATES,
    PreviewParameters,
    _model,
    preview_gains,
)

CONFIG = Path(__file__).parents[3] / "config"
CARS = sorted(path.stem for path in (CONFIG / "vehicles").glob("*.yaml"))
BEND = {"shape": "arcs", "length": [20.0, 500.0], "curvature": [0.0, 0.0]}
STRAIGHT = {"shape": "waypoints", "x": [-1000.0, 2000.0], "y": [0.0, 0.0]}
SPEEDS_DRIVEN = [kmh / 3.6 for kmh in (30, 40, 50, 60, 80, 100, 120, 140)]


@pytest.mark.sampled
@pytest.mark.parametrize("car", CARS)
def test_every_car_settles_on_a_straight_road_at_every_speed(car):
    """1 m beside it: within 1 % after 6 s, and never beyond by more than 1 %.

    Measured 0.5 %, and nothing beyond.
    """
    found = drives(car, SPEEDS_DRIVEN, STRAIGHT, 8.0, plant__initial_y=1.0)
    aside = found.signals["pose.y"]
    assert np.abs(aside[:, found.time > 6.0]).max() < 0.01
    assert aside.min() > -0.01


@pytest.mark.sampled
@pytest.mark.parametrize("car", CARS)
def test_every_car_settles_in_reverse(car):
    """Backwards a car is steered by the axle behind.

    1 m beside, at 3 to 8 m/s, within 2 cm after 12 s.
    """
    found = drives(car, [-3.0, -5.0, -8.0], STRAIGHT, 14.0, plant__initial_y=1.0)
    assert np.abs(found.signals["pose.y"][:, found.time > 12.0]).max() < 0.02


@pytest.mark.parametrize("car", CARS)
@pytest.mark.sampled
def test_bends_of_3_m_per_s2_are_followed(car):
    """The car stays within 0.45 m of a sudden bend, and within 2 cm per m/s^2 at its end.

    Speeds are 30 to 140 km/h. The driver learns what tyres lose against their slope at rest. The
    kei car of Ge & Ni has 40 % more of that, so 2 m/s^2, and its tyres slide so slowly that it is
    still on its way: 0.2 m.
    """
    acceleration = 2.0 if car == "ge_ni2005" else 3.0
    radii = [speed * speed / acceleration for speed in SPEEDS_DRIVEN]
    bends = {"driver.path.curvature": [[0.0, 1.0 / radius] for radius in radii]}
    found = drives(car, SPEEDS_DRIVEN, {**BEND, "length": [80.0, 5000.0]}, 12.0, bends)
    for run, radius in enumerate(radii):
        aside = from_circle(found, run, 80.0, radius)
        assert np.abs(aside).max() < 0.45, SPEEDS_DRIVEN[run]
        assert abs(aside[-1]) < (0.2 if car == "ge_ni2005" else 0.06), SPEEDS_DRIVEN[run]


@pytest.mark.parametrize("preview_time", [0.5, 1.0, 3.0])
def test_a_circle_is_followed_without_error_on_linear_tyres(preview_time):
    """Understeer is known and the bend goes on behind the horizon: 4 m/s^2 at 80 km/h after 8 s.

    The result does not depend on the preview time. 3 cm are left by sines of slip angles and by
    drive forces that pull the front wheels inwards; a driver that takes the car for neutral would
    leave 9 m.
    """
    radius = (80 / 3.6) ** 2 / 4.0
    linear = {
        "*__vehicle__centre_of_mass_height": 0.0,
        "*__vehicle__tyre__curve": "linear",
        "*__vehicle__tyre__coefficients": [20.0, 0.0, 0.0, 0.0],
        "*__vehicle__tyre__combined": "uncoupled",
    }
    bend = {"shape": "arcs", "length": [80.0, 500.0], "curvature": [0.0, 1.0 / radius]}
    found = drives(
        "audi_a2", [80 / 3.6], bend, 14.0, driver__preview__preview_time=preview_time, **linear
    )
    aside = from_circle(found, 0, 80.0, radius)
    assert np.abs(aside[found.time[: len(aside)] > 8.0]).max() < 0.03


@pytest.mark.parametrize("speed", [22.0, -8.0])
def test_left_and_right_are_alike_to_the_bit(speed):
    bend = {**BEND, "start_x": -60.0 if speed < 0.0 else 0.0}  # backwards it comes out of the bend
    both = {"driver.path.curvature": [[0.0, 0.008], [0.0, -0.008]]}
    found = drives("compact_ev", [speed, speed], bend, 5.0, both)
    for name in ("pose.y", "steering_column.state.angle", "driver.command.hand_torque"):
        left, right = found.signals[name]
        assert np.abs(left).max() > 0.0 and (left == -right).all(), name


def test_gains_are_those_of_the_textbook():
    """The Riccati equation and matrix exponential of scipy agree, at all speeds both ways."""
    p, car = PreviewParameters(), Vehicle()
    speeds = np.array([*GAIN_SPEEDS, *(-speed for speed in GAIN_SPEEDS)])
    gains, (a, b) = preview_gains(p, car), _model(p, car, speeds)
    points = int(gains.points)
    assert points == 40
    for n, speed in enumerate(speeds):
        both = np.zeros((len(STATES) + 1, len(STATES) + 1))
        both[:-1] = np.hstack([a[n], b[n]])
        stepped = expm(both * POINT_STEP)
        a_step, b_step = stepped[:-1, :-1], stepped[:-1, -1:]
        away = np.array([[1.0, 0.0, speed, 0.0, 0.0, 0.0, 0.0]])
        weight = away.T @ away / p.lateral_rate**2
        weight[LATERAL_ERROR, LATERAL_ERROR] += 1.0 / p.lateral_error**2
        cost = solve_discrete_are(a_step, b_step, weight, np.array([[1.0 / p.steering_rate**2]]))
        share = 1.0 / p.steering_rate**2 + b_step.T @ cost @ b_step
        feedback = b_step.T @ cost @ a_step / share
        assert gains.feedback[n * len(STATES) : (n + 1) * len(STATES)] == pytest.approx(
            feedback[0], rel=1e-6
        )
        ahead, kept = cost[:, HEADING_ERROR], (a_step - b_step @ feedback).T
        for gain in gains.preview[n * points : (n + 1) * points - 1]:
            assert gain == pytest.approx((b_step[:, 0] @ ahead / share).item(), rel=1e-6, abs=1e-6)
            ahead = kept @ ahead


def test_a_flat_front_tyre_is_learnt():
    """R = 100 m at 60 km/h with 30 % of the outer front tyre's stiffness.

    Without learning 0.9 m are left.
    """
    bend = {"shape": "arcs", "length": [40.0, 600.0], "curvature": [0.0, 0.01]}
    flat: dict[str, Any] = {"plant__faults": ["puncture front_right 1 from 5"]}
    ends = {}
    for learning in (6.0, 1e6):
        flat["driver__preview__learning"] = learning
        ends[learning] = abs(
            from_circle(drives("audi_a2", [60 / 3.6], bend, 15.0, **flat), 0, 40.0, 100.0)[-1]
        )
    assert ends[6.0] < 0.1 * ends[1e6] and ends[1e6] > 0.5, ends


def test_a_car_that_goes_aside_without_turning_settles_as_well():
    """Rear wheels that turn as far as the front ones leave no yaw to learn from.

    1 m beside, within 1 cm after 6 s.
    """
    crab = {"*__vehicle__rear_steering_ratio": 1.0, "plant__initial_y": 1.0}
    found = drives("compact_ev", [80 / 3.6], STRAIGHT, 8.0, **crab)
    assert np.abs(found.signals["pose.y"][:, found.time > 6.0]).max() < 0.01
