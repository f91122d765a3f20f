"""Metrics by name.

Each declared once, needed channels true, the same number wherever it is asked for.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import ev_stack
from ev_core.lockstep.configuration import configure
from ev_msgs_py.refusal import ParameterError
from ev_sim.understeer import understeer_gradient
from ev_stack.measures.metric import HIGHER, LOWER
from ev_stack.measures.named import DrivenRun, driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import known_metrics
from ev_stack.report.result import Result
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import Overrides, load_scenario

OF_A_BUS = [name for name in METRICS if name.startswith("bus_")]
# Of laps (tests/ev_sim/driver/test_lap.py), of one plant, of a ramp, of a car that rolls.
OF_SOME = [
    "lap_time",
    "path_error",
    "peak_winding_temperature",
    "understeer_gradient",
    "maximum_roll_angle",
]
OF_A_CAR = [name for name in METRICS if name not in (*OF_A_BUS, *OF_SOME)]


@cache
def result() -> Result:
    """A run through the first bends of a lane change, with a noisy yaw rate sensor."""
    noise = {"plant.sensors.imu_yaw_rate.noise": 0.01}
    return ev_stack.run("double_lane_change", metrics=OF_A_CAR, duration=3.0, set=noise, seed=1)


def driven() -> DrivenRun:
    (run,) = result().scenario.runs
    return driven_run(result().truth[run.name], run.configurations)


@pytest.mark.parametrize("name", OF_A_CAR)
def test_a_metric_needs_the_channels_that_it_names_and_no_others(name):
    """All but its optional ones.

    Without friction the wanted yaw rate is not limited, which it is not here.
    """
    each, run = METRICS[name], driven()
    assert each.measured(run).value == result().metrics[name].value is not None
    channels = {
        key: values for key, values in run.signals.channels.items() if key.startswith(each.needs)
    }
    assert (
        each.measured(run._replace(signals=Recording(run.signals.time, channels))).value
        == each.measured(run).value
    )
    for need in each.needs:
        less = {key: values for key, values in channels.items() if not key.startswith(need)}
        assert each.lacking(less) == need
        assert each.measured(run._replace(signals=Recording(run.signals.time, less))).value is None


def test_the_understeer_gradient_of_a_slow_ramp_is_that_of_the_linear_car():
    """Either way; 5 %.

    On the ramp the car lags behind its steady state, and the closed form has no drive forces.
    """
    scenario = load_scenario("steady_circle", Overrides(), ("linear",))
    configurations = scenario.runs[0].configurations
    for end in (1.0, -1.0):
        profile = {"profile.time": [1.0, 5.0], "profile.angle": [0.0, end]}
        turned = configure("steering_column", {"method": "steering_robot", **profile})
        speed = {"speed_profile.time": [0.0], "speed_profile.speed": [20.0]}
        run = {
            **configurations,
            "plant": configurations["plant"].changed({"initial_speed": 20.0}),
            "driver": configurations["driver"].changed(speed),
            "steering_column": replace(turned, common=configurations["plant"].common),
        }
        driven = driven_run(run_offline(run, 6.0), run)
        of_car = understeer_gradient(driven.vehicle)
        assert METRICS["understeer_gradient"].measured(driven).value == pytest.approx(
            of_car, rel=0.05
        )


@pytest.mark.parametrize(
    ("scenario", "run"),
    [
        ("sine_with_dwell", "times_3_5"),
        ("obstacle_avoidance", "obstacle_avoidance"),
        ("double_lane_change", "double_lane_change"),
        ("shchur2019", "shchur2019"),
    ],
)
def test_the_understeer_gradient_is_not_measured_where_the_car_does_not_turn_steadily(
    scenario, run
):
    """Slopes of a neutral car would be 0.0101, 0.0055, -0.0031, -0.0125 there."""
    runs = ev_stack.run(
        scenario,
        runs=[run] if scenario == "sine_with_dwell" else [],
        metrics=["understeer_gradient"],
    )
    found = runs.metrics["understeer_gradient"]
    assert found.value is None
    assert found.reason.startswith("the car does not turn steadily: ")


@pytest.mark.parametrize("car", ["audi_a2", "racing_car"])
def test_the_ramp_of_the_standard_is_steady_enough(car):
    """FMVSS 126, S7.6, which the boards record the gradient on."""
    run = ev_stack.run(
        "sine_with_dwell",
        runs=["slowly_increasing_steer"],
        vehicle=car,
        metrics=["understeer_gradient"],
    )
    assert 0.0 < run.metrics["understeer_gradient"].value < 0.0015


def test_a_bus_has_its_metrics():
    found = ev_stack.run("bench_fault", metrics=OF_A_BUS, duration=0.2).metrics
    assert all(found[name].value is not None for name in OF_A_BUS)


def test_a_batch_has_the_metrics_of_its_runs_to_the_bit():
    """Sensors that show another motion change nothing."""
    noise = {"plant.sensors.imu_yaw_rate.noise": 0.01}
    found = ev_stack.batch(
        "double_lane_change", {"*.seed": [0, 1]}, metrics=OF_A_CAR, duration=3.0, set=noise
    ).metrics
    assert {name: values[1] for name, values in found.items()} == {
        name: result().metrics[name].value for name in OF_A_CAR
    }


def test_a_batch_refuses_what_it_cannot_measure_before_it_drives():
    for metric, message in (
        ("peak_slip", "metric peak_slip needs tire_forces.slip_ratio, which "),
        ("peak", "unknown m"),
    ):
        with pytest.raises(ParameterError, match=f"^{message}"):
            ev_stack.batch("shchur2019", metrics=[metric], duration=1e3)


def test_a_batch_names_what_only_reports_measure():
    with pytest.raises(
        ParameterError, match=r"^metric cones_hit is one of the report double_lane_change, expected"
    ):
        ev_stack.batch("double_lane_change", metrics=["cones_hit"], duration=1e3)


def test_torque_activity_friction_use_and_battery_energy_are_what_they_say():
    """Two wheels go to and fro by 10 N m in 2 s: 2 x 20/2 = 20 N m/s.

    300 N and 400 N of 0.5 x 1000 N; 10 W for 2 s.
    """
    time = np.array([0.0, 1.0, 2.0])
    channels = {
        f"{quantity}.{wheel}": np.zeros(3)
        for quantity in (
            "torque_command.drive",
            *(
                f"tire_forces.{of}"
                for of in ("longitudinal_force", "lateral_force", "load", "friction_coefficient")
            ),
        )
        for wheel in ("front_left", "front_right", "rear_left", "rear_right")
    }
    channels["torque_command.drive.front_left"] = channels["torque_command.drive.rear_right"] = (
        np.array([0.0, 10, 0])
    )
    for of, value in (
        ("longitudinal_force", 300.0),
        ("lateral_force", 400.0),
        ("load", 1e3),
        ("friction_coefficient", 0.5),
    ):
        channels[f"tire_forces.{of}.rear_left"] = np.full(3, value)
    channels |= {"battery.voltage": np.full(3, 5.0), "battery.current": np.full(3, -2.0)}
    run = driven()._replace(signals=Recording(time, channels))
    found = {
        name: METRICS[name].measured(run).value
        for name in ("torque_activity", "friction_use", "battery_energy")
    }
    assert found == {"torque_activity": 20.0, "friction_use": 1.0, "battery_energy": 20.0}


@pytest.mark.parametrize("scenario", scenario_names())
def test_every_metric_of_a_scenario_is_known_before_it_is_driven(scenario):
    """Each has a name, a unit and a formula.

    A judged one names the place of its published number.
    """
    found = known_metrics(load_scenario(scenario).runs)
    assert found
    for name, metric in found.items():
        assert metric.unit and metric.better in (LOWER, HIGHER, "")
        assert metric.formula or metric.reference or metric.unjudged or "." in name, name
        if name in METRICS:  # a name means one thing
            assert (metric.unit, metric.formula) == (METRICS[name].unit, METRICS[name].formula)
