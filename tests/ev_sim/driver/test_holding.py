"""Standing: the driver's brake holds every car wherever its tyres do, and stops one that rolls."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from plant.planar.car import STRAIGHT, X, Y, command, plant

from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_sim.driver.pedals import SpeedControlParameters, SpeedControlState, follow_speed
from ev_sim.plant.planar.planar_state import VX
from ev_stack.recording.offline import run_offline
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.scenario import Overrides, load_scenario

CARS = sorted(
    path.stem for path in (Path(__file__).parents[3] / "config" / "vehicles").glob("*.yaml")
)
FEET = SpeedControlParameters()
FRONT_SHARE = 0.6  # of the brakes, as every electronic differential has it by default
ROADS = {
    "dry": ("dry_asphalt", "dry_asphalt"),
    "snow": ("packed_snow_1",) * 2,
    "ice on the left": ("ice", "dry_asphalt"),
}
ROADS["ice on the right"] = ROADS["ice on the left"][::-1]


@cache
def car_named(name: str) -> Vehicle:
    (run, *_) = load_scenario("coast_down", Overrides(vehicle=name)).runs
    return run.configurations["plant"].common.vehicle


def rolls(
    vehicle: Vehicle,
    road: str,
    grade: float,
    seconds: float,
    *,
    locked: bool = False,
    speed: float = 0.0,
) -> tuple[float, float]:
    """Distance [m] and speed [m/s] of a car that a driver holds, or that has locked wheels."""
    left, right = ROADS[road]
    moving = plant(
        vehicle, road__grade=(grade,), road__left=(left,), road__right=(right,), initial_speed=speed
    )
    car, feet, drive, brakes = (
        namespace(car_numbers(vehicle)),
        SpeedControlState(),
        0.0,
        (4000.0,) * 4,
    )
    driven = np.array(car.driven) / car.number_driven
    for _ in range(round(seconds / 0.01)):
        if not locked:
            drive, brake = follow_speed(FEET, car, feet, 0.01, 0.0, float(moving.state[VX]))
            front, rear = 0.5 * brake * FRONT_SHARE, 0.5 * brake * (1.0 - FRONT_SHARE)
            brakes = (front, front, rear, rear)
        moving.advance(command(tuple(drive * driven), brakes), STRAIGHT)
    return float(np.hypot(moving.state[X], moving.state[Y])), abs(float(moving.state[VX]))


def stands(vehicle: Vehicle, road: str, grade: float, *, locked: bool = False) -> bool:
    """Less than 1 cm and 1 mm/s after 5 s.

    Near its limit of friction a tyre still slides a little until it holds.
    """
    distance, speed = rolls(vehicle, road, grade, 5.0, locked=locked)
    return distance < 0.01 and speed < 1e-3


def steepest(vehicle: Vehicle, road: str, direction: float) -> float:
    """The largest grade, of at most 1, on which the car stands with all its wheels locked."""
    low, high = 0.0, 1.0
    if stands(vehicle, road, direction * high, locked=True):
        return high
    for _ in range(8):
        middle = 0.5 * (low + high)
        if stands(vehicle, road, direction * middle, locked=True):
            low = middle
        else:
            high = middle
    return low


@pytest.mark.parametrize("direction", [1.0, -1.0], ids=["uphill", "downhill"])
@pytest.mark.parametrize("road", ROADS)
@pytest.mark.parametrize("name", CARS)
@pytest.mark.sampled
def test_a_driver_that_wants_to_stand_stands_up_to_the_steepest_slope_that_friction_holds(
    name, road, direction
):
    """It stands at 97 %, half and a tenth of the slope on which locked wheels slide."""
    vehicle = car_named(name)
    limit = steepest(vehicle, road, direction)
    assert limit > {"dry": 0.4, "snow": 0.15}.get(road, 0.1)
    for share in (0.1, 0.5, 0.97):
        assert stands(vehicle, road, share * limit * direction)


@pytest.mark.parametrize("name", CARS)
def test_the_brakes_of_a_car_take_what_holds_it(name):
    """A run in which the car stands notes no command out of range."""
    vehicle = car_named(name)
    _, brake = follow_speed(
        FEET, namespace(car_numbers(vehicle)), SpeedControlState(), 0.01, 0.0, 0.0
    )
    assert 0.5 * brake * max(FRONT_SHARE, 1.0 - FRONT_SHARE) <= vehicle.maximum_brake_torque


@pytest.mark.parametrize("speed", [0.5, -0.5])
@pytest.mark.parametrize("grade", [0.12, -0.12, 0.0])
@pytest.mark.parametrize("name", CARS)
def test_a_car_that_rolls_comes_to_rest_and_stays(name, grade, speed):
    """Either way, up and down.

    It stands after 10 s, which the integral action of 0.5/s needs on the slope.
    """
    assert rolls(car_named(name), "dry", grade, 10.0, speed=speed)[1] < 1e-6


def test_an_engine_that_creeps_does_not_swing_the_car():
    """517 N m of creep against 500 of a brake that knew no car.

    +-0.4 m/s for ever, the selector to and fro.
    """
    values = (("driver", "speed_profile.speed", (0.0,)), ("plant", "initial_speed", 0.5))
    (run, *_) = with_own_angles(
        load_scenario("step_steer", Overrides(vehicle="engine_4x4", values=values))
    ).runs
    recording = run_offline(run.configurations, 20.0)
    assert np.abs(recording.channels["twist.longitudinal"][1000:]).max() < 1e-6
