"""Wheels of different radii.

Rim speeds, their difference, and the mass that rotating wheels add.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ev_core.vehicle.driveline import wheel_inertias
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.manoeuvres.coast_down import effective_mass
from ev_stack.manoeuvres.launch_split_mu import split_friction_figures
from ev_stack.measures import motion
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.files import vehicle_of

RATIOS = (1.0, 0.98, 1.02, 0.9)
CAR = dataclasses.replace(vehicle_of("audi_a2"), wheel_radius_ratio=RATIOS)
ROLLING = {
    name: 10.0 / (CAR.wheel_radius * ratio) for name, ratio in zip(WHEEL_NAMES, RATIOS, strict=True)
}
SPEEDS = {f"wheel_states.velocity.{name}": np.full(3, turns) for name, turns in ROLLING.items()}
RUN = Recording(np.arange(3) * 0.01, {**SPEEDS, "pose.x": np.zeros(3), "pose.y": np.zeros(3)})


def test_the_rims_of_all_wheels_of_a_rolling_car_have_its_speed():
    for wheel in WHEEL_NAMES:
        assert motion.rim_speed(RUN, CAR, wheel) == pytest.approx(10.0)
    assert motion.speed_difference(RUN, CAR) == pytest.approx(0.0, abs=1e-12)


def test_rim_speeds_are_drawn_with_the_radius_of_each_wheel():
    sheet = split_friction_figures("launch", {"run": RUN}, CAR, WHEEL_NAMES)["launch"]
    (rims,) = [panel for panel in sheet.panels if panel.title.startswith("Rim speeds")]
    assert [curve.values[0] for curve in rims.curves] == pytest.approx([10.0] * 4)


def test_a_smaller_wheel_that_turns_faster_adds_more_mass():
    """Kinetic energy of rotation J w^2/2 with w = V/r of each wheel."""
    energy = sum(
        inertia * ROLLING[wheel] ** 2
        for wheel, inertia in zip(WHEEL_NAMES, wheel_inertias(CAR), strict=True)
    )
    assert effective_mass(CAR) == pytest.approx(CAR.mass + energy / 100.0)
