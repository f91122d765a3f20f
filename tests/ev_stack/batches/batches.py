"""A batch to be held against its runs one by one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, load_scenario

DURATION = 3.0
RUNS = 5
SENSORS = {
    "imu_yaw_rate": "noise",
    "wheel_speed": "noise",
    "body_velocity": "dropout",
    "body_heading": "delay",
}


@cache
def lane_change() -> Mapping[str, Configuration]:
    """The planar car in a double lane change, some of its sensors far from ideal."""
    errors = {"noise": 0.05, "dropout": 0.3, "delay": 2}
    values = [
        ("plant", f"sensors.{name}.{error}", errors[error]) for name, error in SENSORS.items()
    ]
    return load_scenario("double_lane_change", Overrides(values=values)).runs[0].configurations


def vary() -> dict[str, list[Any]]:
    """Values of every kind.

    Of a method, of all roles, of a sensor, an array, of the car, and faults.
    """
    return {
        "plant.initial_speed": [18.0 + run for run in range(RUNS)],
        "*.seed": list(range(RUNS)),
        "*.vehicle.mass": [1100.0 + 10.0 * run for run in range(RUNS)],
        "plant.sensors.wheel_speed.bias": [0.1 * run for run in range(RUNS)],
        "driver.speed_profile.speed": [[18.0 + run] for run in range(RUNS)],
        "plant.faults": [
            ["lost wheel_states 0.3", f"motor_share front_left 0 from {run}"] for run in range(RUNS)
        ],
        "steering_column.faults": [["delayed steering_column 0.03 from 2.5"]] * RUNS,
    }


def alone(run: int, duration: float = DURATION) -> Recording:
    """The recording of one run of the batch, driven as ever."""
    configurations = dict(lane_change())
    for name, values in vary().items():
        role, _, parameter = name.partition(".")
        for each in configurations if role == "*" else (role,):
            configurations[each] = configurations[each].changed({parameter: values[run]})
    return run_offline(configurations, duration)
