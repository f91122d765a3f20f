"""No tyre ever gives more than its friction, whatever changes under it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plant.planar.car import CAR, FOUR_MOTORS, STRAIGHT, X, command, on, outputs, plant, steered

from ev_msgs_py.contract.signals import TireForces
from ev_sim.plant.planar.planar_state import VX

FALLS = (("dry_asphalt", "ice"), ("wet_asphalt_1", "packed_snow_1"), ("packed_snow_1", "ice"))
INPUTS = {
    "driving": (command(drive=(1500.0,) * 4), STRAIGHT),
    "braking": (command(brake=(2000.0,) * 4), STRAIGHT),
    "cornering": (command(drive=(150.0,) * 4), steered(0.3)),
}


@pytest.mark.parametrize("inputs", INPUTS.values(), ids=INPUTS)
@pytest.mark.parametrize("speed", [1.0, 5.0, 20.0])
@pytest.mark.parametrize("jump", [*FALLS, *(fall[::-1] for fall in FALLS)], ids=" to ".join)
def test_forces_stay_within_the_friction_circle(jump, speed, inputs):
    """|F| <= mu N at every sample of 1 ms over a jump of friction, to rounding."""
    ahead = FOUR_MOTORS.wheelbase - FOUR_MOTORS.centre_of_mass_to_rear_axle
    way = ahead + 0.03 * speed**2  # so short that a braked car reaches the jump
    road = {"road__left": jump, "road__right": jump, "road__length": (way,)}
    moving = plant(FOUR_MOTORS, period=1e-3, initial_speed=speed, road__pattern="segments", **road)
    use, friction = [], set()
    for _ in range(1000):
        moving.advance(*inputs)
        tyres = outputs(moving)[TireForces]
        force = np.hypot(tyres.longitudinal_force, tyres.lateral_force)
        use.append(force - np.array(tyres.friction_coefficient) * tyres.load)
        friction.add(tyres.friction_coefficient.front_left)
    assert len(friction) == 2
    assert np.max(use) < 1e-6  # [N]


@pytest.mark.parametrize(("surface", "grade"), [("ice", 0.2), ("packed_snow_2", -0.4)])
def test_parked_on_too_steep_a_slope_the_car_slides_at_once(surface, grade):
    """Way a t^2/2, a = g (p - mu)/sqrt(1 + p^2), mu between peak and full slip."""
    sliding = plant(CAR, road__grade=(grade,), **on(surface))
    start = sliding.state[X]
    for n in range(1, 101):
        sliding.advance(command(brake=(3000.0,) * 4), STRAIGHT)
        down = math.copysign(1.0, grade) * (start - sliding.state[X])
        peak = outputs(sliding)[TireForces].friction_coefficient.front_left
        slowest, fastest = (
            9.81 * (abs(grade) - mu) / math.hypot(1.0, grade) for mu in (peak, 0.66 * peak)
        )
        if n >= 5:
            assert 0.98 * slowest < 2.0 * down / (0.01 * n) ** 2 < 1.02 * fastest
    assert abs(sliding.state[VX]) > 1.0
