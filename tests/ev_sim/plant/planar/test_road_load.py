"""A road load A + B V + C V^2, of a coast-down or dynamometer, in place of f_0 and c_d A."""

from __future__ import annotations

import dataclasses

import pytest
from plant.planar.car import CAR, STRAIGHT, command, plant

from ev_core.vehicle.description import RoadLoad
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.planar_state import VX

A, B, C = 160.0, 2.0, 0.4  # N, N s/m, N s^2/m^2
GIVEN = dataclasses.replace(
    CAR,
    rolling_resistance=0.0,
    drag_coefficient=0.0,
    road_load=RoadLoad(constant=A, linear=B, quadratic=C),
)


@pytest.mark.parametrize("direction", (1.0, -1.0))
def test_a_coasting_car_loses_speed_by_its_road_load(direction):
    """m_eff V' = -(A + B V + C V^2) within 0.1 %.

    Carcasses and loads settle within the first tenth of a second.
    """
    car = plant(GIVEN, initial_speed=20.0 * direction)
    for _ in range(50):
        car.advance(command(), STRAIGHT)
    before = car.state[VX]
    for _ in range(100):
        car.advance(command(), STRAIGHT)
    speed = 0.5 * (before + car.state[VX])
    inertia = GIVEN.mass + 4 * GIVEN.wheel_inertia / GIVEN.wheel_radius**2
    force = A + B * abs(speed) + C * speed**2
    assert before - car.state[VX] == pytest.approx(direction * force / inertia, rel=1e-3)


def test_the_same_load_by_rolling_resistance_and_drag_is_the_same_run():
    """B = 0; to rounding, for A/(m g) and C are made by other divisions and products."""
    area = CAR.drag_coefficient * CAR.frontal_area
    constant, quadratic = CAR.rolling_resistance * CAR.mass * 9.81, 0.5 * CAR.air_density * area
    load = RoadLoad(constant=constant, quadratic=quadratic)
    same = dataclasses.replace(CAR, rolling_resistance=0.0, drag_coefficient=0.0, road_load=load)
    speeds = []
    for vehicle in (CAR, same):
        car = plant(vehicle, initial_speed=25.0)
        for _ in range(200):
            car.advance(command(drive=(50.0, 50.0, 0.0, 0.0)), STRAIGHT)
        speeds.append(car.state[VX])
    assert speeds[0] == pytest.approx(speeds[1], rel=1e-12)


def test_a_standing_car_stands():
    car = plant(GIVEN)
    for _ in range(50):
        car.advance(command(), STRAIGHT)
    assert car.state[VX] == 0.0


@pytest.mark.parametrize("name", ("rolling_resistance", "drag_coefficient"))
def test_both_are_refused(name):
    with pytest.raises(
        ParameterError, match=f"road_load stands in the place of {name}, expected 0"
    ):
        dataclasses.replace(GIVEN, **{name: 0.01})
