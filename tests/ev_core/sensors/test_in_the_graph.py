"""Sensors in whole graphs.

What an error does, and that it is the same however the graph is driven.
"""

from __future__ import annotations

import math

import pytest
from helpers.fake_network import FakeNetwork, Faults
from sensors.rows import EVERYTHING

from ev_core.lockstep.configuration import Configuration
from ev_core.sensors.row import QUANTITIES
from ev_msgs_py.contract.signals import SteeringColumnState
from ev_msgs_py.contract.wheels import Wheels
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.scenarios.scenario import Overrides, load_scenario

COLUMN = [quantity.name for quantity in QUANTITIES if quantity.signal is SteeringColumnState]


def graph(seed: int = 0, **values: object) -> dict[str, Configuration]:
    """The paper's car with sensors: `node__quantity__error`."""
    names = [name.split("__") for name in values]
    overrides = [
        (node, f"sensors.{q}.{e}", v)
        for (node, q, e), v in zip(names, values.values(), strict=True)
    ]
    return dict(
        load_scenario("shchur2019", Overrides(values=[*overrides, ("*", "seed", seed)]))
        .runs[0]
        .configurations
    )


def differing(one: Recording, other: Recording) -> set[str]:
    return {name for name in one.channels if (one.channels[name] != other.channels[name]).any()}


def test_an_unread_sensor_changes_its_own_channels_only():
    """Shchur's laws do not read the imu.

    Truth stays truth, and another sensor's noise stays the same.
    """
    true = run_offline(graph(), 2.0)
    assert signal_hash(run_offline(graph(seed=5), 2.0)) == signal_hash(true)
    one = run_offline(graph(plant__imu_yaw_rate__noise=0.01), 2.0)
    assert differing(one, true) == {"imu.yaw_rate"}
    two = run_offline(graph(plant__imu_yaw_rate__noise=0.01, plant__motor_torque__noise=1.0), 2.0)
    assert differing(two, one) == {f"motor_states.effort.{wheel}" for wheel in Wheels._fields}


def test_seed_decides_the_run():
    noisy = {"plant__wheel_torque__noise": 5.0, "steering_column__steering_angle__noise": 1e-3}
    hashes = [signal_hash(run_offline(graph(seed, **noisy), 1.0)) for seed in (1, 1, 2)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_lost_messages_and_a_reset_do_not_change_what_sensors_show():
    """Steppers on a faulty network give the offline run bit by bit, also after a reset."""
    sensors = {
        "plant": ("wheel_speed", "wheel_torque", "body_velocity", "body_heading"),
        "steering_column": COLUMN,
    }
    names = [
        f"{role}__{quantity}" for role, quantities in sensors.items() for quantity in quantities
    ]
    errors = {f"{name}__{error}": value for name in names for error, value in EVERYTHING.items()}
    configurations = graph(seed=4, **errors)
    offline = run_offline(configurations, 1.0)
    network = FakeNetwork(configurations, 100, seed=1, faults=Faults(0.1, 0.1, 0.001))
    for _ in range(2):
        network.forgives = True  # messages of the run before the reset may still be under way
        network.begin()
        network.run()
        assert network.signals() == {
            name: [float.hex(number) for number in column.tolist()]
            for name, column in offline.channels.items()
        }


def test_plant_and_column_read_each_other_as_measured():
    """The actuator that turns the road wheels trusts its sensor.

    A bias of the road-wheel angle steers the car.
    """
    values = {"steering_column__road_wheel_angle__bias": 0.01}
    measured = run_offline(graph(**values), 6.0).channels
    speed, yaw_rate = measured["twist.longitudinal"][-1], measured["twist.yaw_rate"][-1]
    assert speed > 3.0
    assert yaw_rate == pytest.approx(speed * math.tan(0.01) / 2.405, rel=1e-3)
