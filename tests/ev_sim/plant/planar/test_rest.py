"""Rest, slopes, pull-away and locked wheels: what a static slip could not do."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plant.planar.car import CAR, STRAIGHT, X, Y, by_each_way, command, on, outputs, plant, steered

from ev_msgs_py.contract.signals import InertialMeasurement, TireForces
from ev_sim.plant.planar.planar_state import VX, WHEEL_SPEED

pytestmark = by_each_way


@pytest.mark.parametrize(
    ("surface", "grade"),
    [
        ("dry_asphalt", 0.2),
        ("dry_asphalt", -0.2),
        ("packed_snow_1", 0.2),
        ("ice", 0.04),
        ("ice", 0.0),
    ],
)
def test_parked_on_a_slope_the_car_stays(surface, grade, way):
    """Less than 1 mm in 60 s on 20 %, on ice (0.05) on 4 %: measured are nanometres."""
    car = plant(road__grade=(grade,), **on(surface), **way)
    moved = []
    for _ in range(6000):
        car.advance(command(brake=(2000.0,) * 4), STRAIGHT)
        moved.append(abs(car.state[X]) + abs(car.state[Y]))
    assert max(moved) < 1e-6


def test_braked_to_rest_on_a_slope_the_car_stays(way):
    """The rocking after the stop dies away, and then the car moves less than 1 mm in 60 s."""
    car = plant(road__grade=(0.2,), road__side_slope=(0.05,), initial_speed=8.0, **way)
    for _ in range(500):
        car.advance(command(brake=(1500.0,) * 4), steered(0.05))
    at, lateral = car.state[X], car.state[Y]
    for _ in range(6000):
        car.advance(command(brake=(1500.0,) * 4), steered(0.05))
    assert abs(car.state[X] - at) < 1e-3
    assert abs(car.state[Y] - lateral) < 1e-3


def test_without_brakes_the_car_rolls_down(way):
    """The acceleration is g sin(atan 0.2) - f g cos(..) over the mass with four wheels.

    1 + 4 J/(m r^2).
    """
    car = plant(dataclasses.replace(CAR, drag_coefficient=0.0), road__grade=(0.2,), **way)
    for _ in range(300):
        car.advance(command(), STRAIGHT)
    slope = np.hypot(1.0, 0.2)
    expected = -9.81 * (0.2 - 0.015) / slope / (1.0 + 4 * 1.0 / (1400 * 0.294**2))
    assert outputs(car)[InertialMeasurement].longitudinal_acceleration == pytest.approx(
        expected, rel=2e-3
    )


@pytest.mark.parametrize(
    ("surface", "torque"),
    [
        ("dry_asphalt", 50.0),
        ("dry_asphalt", 300.0),
        ("dry_asphalt", 2000.0),
        ("ice", 60.0),
        ("ice", 300.0),
    ],
)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_pull_away_slip_has_one_sign(surface, torque, direction, way):
    """The slip keeps its sign at the default step, from creeping to spinning, both ways."""
    car = plant(period=1e-3, **on(surface), **way)
    slip = []
    for _ in range(3000):
        car.advance(command(drive=(direction * torque, direction * torque, 0.0, 0.0)), STRAIGHT)
        slip.append(outputs(car)[TireForces].slip_ratio)
    driven, rolling = direction * np.array(slip)[:, :2], direction * np.array(slip)[:, 2:]
    assert driven.min() >= 0.0  # zero only while rolling resistance still holds the wheel
    assert driven[-1].min() > 0.0
    assert rolling.max() <= 0.0


def test_creep_is_steady(way):
    """0.03 m/s up a slope of 1 % under a speed controller.

    Neither wheel speed nor slip chatters.
    """
    car = plant(road__grade=(0.01,), **way)
    speeds, torque = [], 0.0
    for _ in range(3000):
        error = 0.03 - float(car.state[VX])
        torque += 20.0 * error
        wheel = 0.5 * (2000.0 * error + torque)
        car.advance(command(drive=(wheel, wheel, 0.0, 0.0)), STRAIGHT)
        speeds.append(car.state[WHEEL_SPEED] * 0.294)
    assert np.ptp(speeds[-500:]) < 1e-4
    assert np.mean(speeds[-500:]) == pytest.approx(0.03, rel=0.02)


def test_locked_wheel_stays_locked_and_stops_the_car(way):
    """Locked wheels slide at the friction of full slip: 1.029 (1 - exp(-17.16)) - 0.523 = 0.506."""
    car = plant(dataclasses.replace(CAR, drag_coefficient=0.0), initial_speed=15.0, **way)
    for _ in range(100):
        car.advance(command(brake=(4000.0,) * 4), STRAIGHT)
    assert np.all(car.state[WHEEL_SPEED : WHEEL_SPEED + 4] == 0.0)
    assert outputs(car)[InertialMeasurement].longitudinal_acceleration == pytest.approx(
        -0.506 * 9.81, rel=1e-3
    )
    for _ in range(900):
        car.advance(command(brake=(4000.0,) * 4), STRAIGHT)
    assert abs(car.state[VX]) < 1e-6
