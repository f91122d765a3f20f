"""A car on tyres of TMeasy: at rest, in a bend, and where its tyres slide."""

from __future__ import annotations

import dataclasses
import math

import pytest
from plant.planar.car import CAR, ESTIMATED, STRAIGHT, X, command, on, outputs, plant, steered

from ev_msgs_py.contract.signals import TireForces
from ev_sim.plant.planar.planar_state import VX, YAW_RATE
from ev_sim.understeer import understeer_gradient

ON_TMEASY = dataclasses.replace(CAR, tyre=ESTIMATED, rolling_resistance=0.0, drag_coefficient=0.0)


@pytest.mark.parametrize(("surface", "grade"), [("dry_asphalt", 0.2), ("ice", -0.04)])
def test_parked_on_a_slope_the_car_stays(surface, grade):
    """The carcass holds it, as with every other curve: less than a micrometre in 20 s."""
    car = plant(ON_TMEASY, road__grade=(grade,), **on(surface))
    moved = []
    for _ in range(2000):
        car.advance(command(brake=(2000.0,) * 4), STRAIGHT)
        moved.append(abs(car.state[X]))
    assert max(moved) < 1e-6


@pytest.mark.parametrize("speed", [5.0, 15.0, -5.0])
def test_small_steady_circle_has_the_gradient_of_the_tyres(speed):
    """Yaw rate u delta/(L + K u |u|), with K from the slopes of the side force at the axle loads.

    Within 0.5 %: at 0.001 rad no tyre leaves its slope by more.
    """
    car = plant(ON_TMEASY, initial_speed=speed, speed="held")
    angle = 0.001
    for _ in range(600):
        car.advance(command(), steered(angle))
    gradient = understeer_gradient(ON_TMEASY, ahead=math.copysign(1.0, speed))
    expected = speed * angle / (ON_TMEASY.wheelbase + gradient * speed * abs(speed))
    assert car.state[YAW_RATE] == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("surface", ["dry_asphalt", "packed_snow_1"])
def test_locked_wheels_slide_with_the_sliding_force(surface):
    """F_S at each load: a wheel that stands has an endless slip over the speed of its rim."""
    car = plant(ON_TMEASY, initial_speed=20.0, **on(surface))
    for _ in range(60):
        car.advance(command(brake=(20e3,) * 4), STRAIGHT)
    seen = outputs(car)[TireForces]
    assert 5.0 < car.state[VX] < 19.0
    front = ESTIMATED.numbers("front")
    scale = seen.friction_coefficient.front_left / 1.1292
    for force, load in zip(seen.longitudinal_force, seen.load, strict=True):
        share = load / front[0]
        # Of the pattern of a passenger car tyre: F_S over load at P_N and at twice that.
        sliding = 2.0 * 0.80149 - 0.76917 - (0.80149 - 0.76917) * share
        assert force == pytest.approx(-scale * sliding * load, rel=1e-3)


def test_brakes_and_drives_alike_at_small_slip():
    """Forces at a slip of -s and s of the rim are the same but for their sign."""
    seen = []
    for torque in (200.0, -200.0):
        car = plant(ON_TMEASY, initial_speed=20.0)
        for _ in range(100):
            car.advance(command(drive=(torque, torque, 0.0, 0.0)), STRAIGHT)
        seen.append(outputs(car)[TireForces].longitudinal_force.front_left)
    assert seen[0] > 0.0
    # Loads differ a little between them, and the wheels speed up or slow down.
    assert seen[0] == pytest.approx(-seen[1], rel=0.02)
