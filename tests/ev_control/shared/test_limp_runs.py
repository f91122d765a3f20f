"""Limp modes in whole cars: nothing is taken from sound ones, and drive comes back after faults."""

from __future__ import annotations

import os

import numpy as np
import pytest

import ev_stack
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.batches.observer import mean
from ev_stack.measures.metric import channel

pytestmark = pytest.mark.slow

SEEDS = int(os.environ.get("EV_CASES", "300"))
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
        (
            "layout_1_8_c",
            1500.0,
            {"plant.electrical": True, "*.vehicle.battery.discharge_power": 15000.0},
        ),
        ("compact_ev", 1500.0, {"*.vehicle.battery.discharge_power": 15000.0}),
        ("compact_ev", 2000.0, {"*.vehicle.motor.gear_efficiency": 0.7}),
        ("dissertation_class_b", 4000.0, {"plant.initial_speed": 30.0}),
    ],
    ids=["battery", "voltage", "battery of two motors", "gear", "as shipped at speed"],
)
def test_limits_of_a_car_are_no_loss(vehicle, torque, more):
    """A battery of 15 kW at 20 m/s, a gear that takes 30 %, a car as it is.

    The request passes to the bit.
    """
    values = pedal(torque, 20.0, **more)
    run = ev_stack.run(
        "step_steer", ["left"], vehicle=vehicle, method=LIMP, set=values, duration=1.8
    ).runs["left"]
    assert (drives(run, "torque_command") == drives(run, "torque_request")).all()
    assert drives(run, "torque_command")[:, -1].sum() == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize(
    "fault", ["battery_share battery 0 from 1 until 1.5", "motor_share all 0.5 from 1 until 1.2"]
)
def test_a_short_common_fault_leaves_nothing_behind(fault):
    """Nothing turns the car: the request passes meanwhile, and all drive is back in 0.1 s."""
    values = pedal(1500.0, 10.0, **{"plant.faults": [fault]})
    run = ev_stack.run(
        "step_steer", ["left"], vehicle="layout_1_8_c", method=LIMP, set=values, duration=1.8
    ).runs["left"]
    assert (drives(run, "torque_command") == drives(run, "torque_request")).all()
    acts = sum(channel(run, f"wheel_states.effort.{wheel}") for wheel in WHEEL_NAMES)
    assert acts[-20] == pytest.approx(0.97 * 1500.0, rel=1e-3)  # behind its gears


def test_a_dead_motor_on_the_dry_side_spins_nothing_on_ice():
    """Launch on split friction, one motor dead from 3 s on.

    The sound wheel, limited on ice, never turns back.
    """
    faults = {"plant.faults": ["motor_share front_right 0 from 3"], "asr.limp.watch": True}
    run = ev_stack.run(
        "launch_split_mu",
        ["fixed_steering"],
        method={"asr": "slip_window"},
        set=faults,
        duration=5.0,
    ).runs["fixed_steering"]
    assert channel(run, "torque_command.drive.front_left").min() >= 0.0
    assert channel(run, "wheel_states.velocity.front_left").min() > -0.1
    assert channel(run, "torque_command.drive.front_left")[-1] < 1e-9  # its partner gives nothing


def test_a_tripped_inverter_with_a_dragging_rotor_is_found():
    """A dead motor shows some mN m of either sign, as real ones do, and is found in time."""
    found = {"asr.limp.watch": True}
    run = ev_stack.run("bench_fault", method={"asr": "slip_window"}, set=found, duration=1.15).runs[
        "bench_fault"
    ]
    left, right = (
        channel(run, f"torque_command.drive.{wheel}") for wheel in ("front_left", "front_right")
    )
    assert left[1000] == right[1000] == 500.0
    assert (abs(left[1050:]) < 1.0).all() and (right[1050:] == 500.0).all()


@pytest.mark.parametrize(
    ("vehicle", "share"), [("layout_1_8_c", 0.6), ("compact_ev", 0.2), ("audi_a2", 0.2)]
)
def test_no_drive_is_taken_from_a_sound_car(vehicle, share):
    """Any speed, torque, mass, gear and battery limit, with noise of half the allowed 20 N m."""
    runs = max(round(share * SEEDS), 1)
    chance = np.random.default_rng(1)
    sums = [f"torque_{of}.drive.{wheel}" for of in ("request", "command") for wheel in WHEEL_NAMES]
    found = ev_stack.batch(
        "step_steer",
        {
            "*.seed": range(runs),
            "plant.initial_speed": chance.choice([0.0, 2.0, 10.0, 20.0, 35.0], runs)
            * chance.uniform(0.8, 1.2, runs),
            "driver.pedals.drive_torque": [
                [0.0, 0.0, torque] for torque in chance.uniform(-1500.0, 3000.0, runs)
            ],
            "*.vehicle.mass": chance.uniform(900.0, 2500.0, runs),
            "*.vehicle.motor.gear_efficiency": chance.uniform(0.6, 1.0, runs),
            "*.vehicle.battery.discharge_power": 10.0 ** chance.uniform(3.0, 5.3, runs),
            "*.vehicle.battery.charge_power": 10.0 ** chance.uniform(3.0, 5.3, runs),
            "plant.sensors.wheel_torque.noise": chance.uniform(0.0, 10.0, runs),
            "plant.sensors.wheel_speed.noise": chance.uniform(0.0, 0.2, runs),
        },
        run="left",
        vehicle=vehicle,
        method=LIMP,
        set=pedal(800.0, 10.0),
        duration=1.5,
        metrics={name: mean(name) for name in sums},
    )
    request, command = np.array([found.metrics[name] for name in sums]).reshape(2, 4, runs)
    assert not found.failed
    assert (np.abs(request).sum(axis=0) > 0.0).all()
    assert (request == command).all()
