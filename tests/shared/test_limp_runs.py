"""Limp modes in whole cars: nothing is taken from sound ones, and drive comes back after faults."""

from __future__ import annotations

import os

import numpy as np
import pytest

import ev_sim
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.batches.reductions import mean
from ev_sim.report.samples import channel

pytestmark = pytest.mark.slow

SEEDS = int(os.environ.get("EV_CASES", "1000"))
LIMP = {"asr": "limp_home"}


def pedal(torque: float, speed: float, **more):
    """Straight on at a speed [m/s], with a drive torque [N m] from 0.8 s on."""
    return {
        "plant.initial_speed": speed,
        "driver.pedals.begin": True,
        "driver.pedals.time": [0.0, 0.5, 0.8],
        "driver.pedals.drive_torque": [0.0, 0.0, torque],
        "driver.pedals.brake_torque": [0.0, 0.0, 0.0],
        **more,
    }


def drives(run, of: str) -> np.ndarray:
    """Drive torques of all wheels, (4, n) [N m]."""
    return np.array([channel(run, f"{of}.drive.{wheel}") for wheel in WHEEL_NAMES])


@pytest.mark.parametrize(
    ("vehicle", "torque", "more"),
    [
        ("layout_1_8_c", 1500.0, {"*.vehicle.battery.discharge_power": 15000.0}),
        ("layout_1_8_c", 1500.0, {"plant.method": "planar_electrical", "*.vehicle.battery.discharge_power": 15000.0}),
        ("compact_ev", 1500.0, {"*.vehicle.battery.discharge_power": 15000.0}),
        ("compact_ev", 2000.0, {"*.vehicle.motor.gear_efficiency": 0.7}),
        ("dissertation_class_b", 4000.0, {"plant.initial_speed": 30.0}),
    ],
    ids=["battery", "voltage", "battery of two motors", "gear", "as shipped at speed"],
)
def test_limits_of_a_car_are_no_loss(vehicle, torque, more):
    """A battery of 15 kW at 20 m/s, a gear that takes 30 %, a car as it is: the request passes to the bit."""
    values = pedal(torque, 20.0, **more)
    method = {**LIMP, **({"plant": values.pop("plant.method")} if "plant.method" in values else {})}
    run = ev_sim.run("step_steer", ["left"], vehicle=vehicle, method=method, set=values, duration=1.8).runs["left"]
    assert (drives(run, "torque_command") == drives(run, "torque_request")).all()
    assert drives(run, "torque_command")[:, -1].sum() == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize("fault", ["battery_share battery 0 from 1 until 1.5", "motor_share all 0.5 from 1 until 1.2"])
def test_a_short_common_fault_leaves_nothing_behind(fault):
    """Nothing turns the car, so the request passes during it as well, and all drive is there 0.1 s after it."""
    values = pedal(1500.0, 10.0, **{"plant.faults": [fault]})
    run = ev_sim.run("step_steer", ["left"], vehicle="layout_1_8_c", method=LIMP, set=values, duration=1.8).runs["left"]
    assert (drives(run, "torque_command") == drives(run, "torque_request")).all()
    acts = sum(channel(run, f"wheel_states.effort.{wheel}") for wheel in WHEEL_NAMES)
    assert acts[-20] == pytest.approx(0.97 * 1500.0, rel=1e-3)  # behind its gears


def test_a_dead_motor_on_the_dry_side_spins_nothing_on_ice():
    """Launch on split friction, one motor dead from 3 s on: the sound wheel, limited on ice, never turns back."""
    faults = {"plant.faults": ["motor_share front_right 0 from 3"], "asr.limp.watch": True}
    run = ev_sim.run(
        "launch_split_mu", ["fixed_steering"], method={"asr": "slip_window"}, set=faults, duration=5.0
    ).runs["fixed_steering"]
    assert channel(run, "torque_command.drive.front_left").min() >= 0.0
    assert channel(run, "wheel_states.velocity.front_left").min() > -0.1
    assert channel(run, "torque_command.drive.front_left")[-1] < 1e-9  # its partner gives nothing


def test_a_noisy_torque_sensor_loses_no_motor():
    """Half the allowed deviation of 20 N m as standard deviation, 1.5 s about zero torque and with 400 N m a wheel."""
    sums = [f"torque_{of}.drive.{wheel}" for of in ("request", "command") for wheel in WHEEL_NAMES[:2]]
    found = ev_sim.batch(
        "step_steer",
        {"*.seed": range(SEEDS)},
        run="left",
        method=LIMP,
        set=pedal(800.0, 10.0, **{"plant.sensors.wheel_torque.noise": 10.0}),
        duration=1.5,
        metrics={name: mean(name) for name in sums},
    )
    left, right, *told = (found.metrics[name] for name in sums)
    assert (left > 100.0).all() and not found.failed
    assert (left == told[0]).all() and (right == told[1]).all()
