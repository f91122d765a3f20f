"""A mirrored run is mirrored to the last bit."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from plant.planar.car import ESTIMATED, FOUR_MOTORS, by_each_way, command, plant, steered

from ev_core.parameters.record import names
from ev_sim.plant.planar.planar_state import PlanarState

NAMES = names(PlanarState())
SWAPPED = {"left": "right", "right": "left"}
LATERAL = (
    "lateral_velocity",
    "yaw_rate",
    "heading",
    "lateral_transfer",
    "roll_angle",
    "roll_rate",
    "lateral_deflection",
    "lateral_slip",
)
ODD = (*LATERAL, "y", "road_wheel_angle", "guard.angle")


@by_each_way
@pytest.mark.parametrize("tyre", [FOUR_MOTORS.tyre, ESTIMATED], ids=lambda tyre: tyre.curve)
def test_mirrored_input_gives_the_mirrored_trajectory_to_the_bit(tyre, way):
    generator = np.random.default_rng(5)
    odd = [n for n, name in enumerate(NAMES) if name.startswith(ODD)]
    place = {name: n for n, name in enumerate(NAMES)}
    mirror = [place[re.sub("left|right", lambda side: SWAPPED[side[0]], name)] for name in NAMES]
    snow, dry = ("packed_snow_1",), ("dry_asphalt",)
    car = dataclasses.replace(FOUR_MOTORS, tyre=tyre)
    ours = plant(
        car, initial_speed=12.0, road__left=snow, road__right=dry, road__side_slope=(0.03,), **way
    )
    other = plant(
        car, initial_speed=12.0, road__left=dry, road__right=snow, road__side_slope=(-0.03,), **way
    )
    for _ in range(500):
        fl, fr, rl, rr = generator.uniform(-500, 800, 4)
        bl, br = generator.uniform(0, 600, 2)
        angle, rate = generator.uniform(-0.3, 0.3, 2)
        ours.advance(command((fl, fr, rl, rr), (bl, br, bl, br)), steered(angle, rate))
        other.advance(command((fr, fl, rr, rl), (br, bl, br, bl)), steered(-angle, -rate))
        mirrored = other.state[mirror]
        mirrored[odd] *= -1.0
        assert np.array_equal(ours.state, mirrored)
