"""The method of integration: step width, an adaptive solver, repeatability, memory."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys
from plant.planar.car import (
    CAR,
    STRAIGHT,
    X,
    Y,
    command,
    on,
    outputs,
    parameters_of,
    plant,
    steered,
)
from plant.planar.manoeuvres import MANOEUVRES, end_state
from scipy.integrate import solve_ivp

from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import TireForces
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.body import Equations
from ev_sim.plant.planar.planar_state import (
    INTEGRATED_PLACES,
    INTEGRATED_SIZE,
    VX,
    VY,
    WHEEL_SPEED,
    YAW_RATE,
)
from ev_sim.plant.planar.prepare import number_of_steps


@pytest.mark.parametrize("name", MANOEUVRES)
def test_halving_the_step_changes_nothing(name):
    """0.1 % of velocities, path and wheel speeds after four seconds.

    A tenth of that here, measured are 7e-6.
    """
    coarse, fine = end_state(1e-3, name), end_state(5e-4, name)
    path = max(np.hypot(fine[X], fine[Y]), 1.0)
    speed = max(np.hypot(fine[VX], fine[VY]), 1.0)
    assert np.hypot(coarse[X] - fine[X], coarse[Y] - fine[Y]) < 1e-4 * path
    assert np.abs(coarse[[VX, VY]] - fine[[VX, VY]]).max() < 1e-4 * speed
    wheels = slice(WHEEL_SPEED, WHEEL_SPEED + 4)
    assert np.abs(coarse[wheels] - fine[wheels]).max() < 1e-4 * max(np.abs(fine[wheels]).max(), 1.0)
    assert abs(coarse[YAW_RATE] - fine[YAW_RATE]) < 1e-4 * max(abs(fine[YAW_RATE]), 0.1)


@pytest.mark.weekly
@pytest.mark.parametrize("surface", ["dry_asphalt", "ice"])
def test_against_an_adaptive_solver(surface):
    """The same right-hand side by scipy's DOP853 at a relative tolerance of 1e-9.

    Within 0.1 % after half a second.
    """
    car = plant(initial_speed=6.0, **on(surface))
    car.advance(command(), steered(0.03))
    start = car.state[:INTEGRATED_SIZE].copy()
    equations = Equations(parameters_of(**on(surface)), CAR)
    equations.look(start)
    equations.hold(0.03, drive=(300.0, 250.0, 0.0, 0.0), brake=(0.0, 0.0, 20.0, 20.0))
    equations.rates(start, starts=True)

    def right_hand_side(_time, y):
        return equations.rates(y)

    exact = solve_ivp(right_hand_side, (0.0, 0.5), start, method="DOP853", rtol=1e-9, atol=1e-12).y[
        :, -1
    ]
    ours = start.copy()
    for _ in range(500):
        equations.advance(ours, 1e-3)
    scale = np.maximum(np.abs(exact), 1e-3 * np.abs(exact).max())
    worst = int(np.argmax(np.abs(ours - exact) / scale))
    assert np.abs(ours - exact)[worst] < 1e-3 * scale[worst], INTEGRATED_PLACES[worst].name


def test_the_same_run_gives_the_same_bits():
    one, two = (
        end_state(1e-3, "braking on split friction"),
        end_state(1e-3, "braking on split friction"),
    )
    assert one.tobytes() == two.tobytes()


def test_a_stiff_tyre_on_a_light_wheel_gets_shorter_steps():
    """Carcass of 4 MN/m and wheels of 0.05 kg m^2: still quiet, at more steps."""
    stiff = dataclasses.replace(
        CAR, wheel_inertia=0.05, tyre=Tyre(longitudinal_stiffness=4e6, lateral_stiffness=4e6)
    )
    car = plant(stiff)
    assert (
        number_of_steps(parameters_of(), stiff, 0.01)
        > 10
        == number_of_steps(parameters_of(), CAR, 0.01)
    )
    for _ in range(200):
        car.advance(command(drive=(200.0, 200.0, 0.0, 0.0)), steered(0.05))
    forces = outputs(car)[TireForces]
    assert forces.slip_ratio.front_left == pytest.approx(forces.slip_ratio.front_right, abs=0.01)
    assert 1.0 < car.state[VX] < 3.0
    with pytest.raises(ParameterError, match="stiffness"):
        plant(dataclasses.replace(stiff, wheel_inertia=0.001))


def test_nothing_is_allocated_per_step():
    """Compiled code asks for memory as often for 3000 steps as for 300."""
    _nrt_python.memsys_enable_stats()
    counts = []
    for period in (0.3, 3.0):
        car = plant(period=period, initial_speed=5.0)
        car.advance(command(), STRAIGHT)
        before = rtsys.get_allocation_stats().alloc
        car.advance(
            command(drive=(100.0, 100.0, 0.0, 0.0), brake=(0.0, 0.0, 10.0, 10.0)), steered(0.01)
        )
        counts.append(rtsys.get_allocation_stats().alloc - before)
    assert counts[0] == counts[1]
