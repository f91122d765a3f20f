"""Metrics are about the car.

Not about its sensors, to either side, in reverse, and whatever the control period is.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ev_stack
from ev_core.check.mirror import mirrored
from ev_core.lockstep.parts import row_parts
from ev_msgs_py.contract import frame
from ev_stack.measures.named import driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.offline import run_offline, struck_channels, true_motion
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import report_for
from ev_stack.scenarios.scenario import Overrides, Scenario, load_scenario

DRIVEN = {  # scenario -> how long it takes until all that is measured has happened [s]
    "sine_with_dwell": 5.0,
    "step_steer": 6.0,
    "steady_circle": 100.0,
    "double_lane_change": 9.0,
    "straight_brake_split_mu": 6.0,
    "launch_split_mu": 8.0,
    "hill_start": 65.0,
    "coast_down": 20.0,
    "dead_motor": 6.0,
    "urban_mixed": 40.0,
}


def loaded(name: str, *values: tuple, duration: float | None = None) -> Scenario:
    return load_scenario(name, Overrides(values=values, duration=duration or DRIVEN[name]))


def driven(scenario: Scenario) -> dict[str, Recording]:
    return {run.name: run_offline(run.configurations, run.duration) for run in scenario.runs}


@cache
def as_shipped(name: str) -> tuple[Scenario, dict[str, Recording]]:
    scenario = loaded(name)
    return scenario, driven(scenario)


def metrics_of(
    scenario: Scenario, runs: dict[str, Recording], side: float = 1.0
) -> dict[str, float | str]:
    """Values by name, or the reason for none; a side of -1 mirrors the driver's path as well."""
    first = scenario.runs[0].configurations
    parameters = {role: configuration.values() for role, configuration in first.items()}
    if "path.y" in parameters["driver"]:
        parameters["driver"]["path.y"] = [side * y for y in parameters["driver"]["path.y"]]
    found = report_for(scenario.parameters.report or scenario.name).metrics(
        runs, first["plant"].common.vehicle, parameters, scenario.parameters.course
    )
    return {
        name: each.verdict if each.value is None else each.value for name, each in found.items()
    }


def all_metrics_of(
    scenario: Scenario, runs: dict[str, Recording], side: float = 1.0
) -> dict[str, float | str]:
    """Those of the report, and what is measured of any manoeuvre."""
    of_runs = (handling_of(scenario, run).items() for run in runs.values())
    return metrics_of(scenario, runs, side) | {
        f"{name} {n}": value for n, found in enumerate(of_runs) for name, value in found
    }


def handling_of(scenario: Scenario, run: Recording) -> dict[str, float | str]:
    driven = driven_run(run, scenario.runs[0].configurations)
    found = {name: each.measured(driven) for name, each in METRICS.items()}
    return {
        name: each.verdict if each.value is None else each.value for name, each in found.items()
    }


# Sensors

errors = st.fixed_dictionaries(
    {},
    optional={
        "gain": st.floats(0.8, 1.2),
        "noise": st.floats(0.0, 0.1),
        "delay": st.integers(0, 5),
        "dropout": st.floats(0.0, 0.5),
        "quantisation": st.floats(0.0, 0.1),
    },
)
FAULTS = (
    "constant imu.yaw_rate 0",
    "noisy imu.yaw_rate 0.005",
    "scaled tire_forces.friction_coefficient 1.0001",
    "lost twist 0.3 from 1",
    "frozen pose from 2",
    "swapped wheel_states.velocity.front_left,wheel_states.velocity.front_right",
)


@settings(max_examples=6)
@given(
    st.dictionaries(
        st.sampled_from(["imu_yaw_rate", "imu_acceleration", "body_velocity", "wheel_speed"]),
        errors,
    ),
    st.lists(st.sampled_from(FAULTS), max_size=2, unique=True),
    st.sampled_from(
        [
            "",
            "offset steering_column/state.road_wheel_angle 0.01",
            "noisy steering_column/state 0.01",
        ]
    ),
)
def test_sensors_and_faults_make_of_the_truth_what_was_recorded(sensors, faults, of_column):
    """Sensors and faults behind the found truth give the recorded numbers to the bit."""
    values = [
        ("plant", f"sensors.{name}.{of}", value)
        for name, errors in sensors.items()
        for of, value in errors.items()
    ]
    values += [
        ("plant", "faults", faults),
        ("steering_column", "faults", [of_column] * bool(of_column)),
    ]
    scenario = loaded("double_lane_change", *values, duration=3.0)
    (run,), (recording,) = scenario.runs, driven(scenario).values()
    truth = true_motion(recording, run.configurations)
    assert not truth.unknown
    frames = np.zeros((len(truth.time), frame.SIZE))
    frames[:, frame.TIME] = truth.time
    for name, place in frame.channels().items():
        if name in truth.channels:
            frames[:, place] = truth.channels[name]
    from ev_core.compiling.machine_code import call

    parts = [
        part
        for role in ("plant", "steering_column")
        for part in row_parts(run.configurations[role])
    ]
    for row in frames:
        for part in parts:
            function, state, constants = part.addresses()
            call(function, 0, row.ctypes.data, state, constants)
    for name, place in frame.channels().items():
        if name in recording.channels:
            assert np.array_equal(frames[:, place], recording.channels[name]), name


@pytest.mark.parametrize("name", ["step_steer", "sine_with_dwell"])
def test_metrics_are_those_of_the_motion_whatever_its_sensors_show(name):
    """No node of the loop reads these sensors (the driver reads `twist`).

    So the motion is the same to the bit.
    """
    scenario, runs = as_shipped(name)
    unread = ("imu_yaw_rate", "imu_acceleration", "wheel_speed", "tire_slip_ratio", "body_heading")
    values = [
        ("plant", f"sensors.{sensor}.{of}", value) for sensor in unread for of, value in BAD.items()
    ]
    values.append(
        (
            "plant",
            "faults",
            ["constant imu.yaw_rate 0", "scaled tire_forces 1.1", "frozen pose from 0.5"],
        )
    )
    shown = driven(loaded(name, *values))
    assert all_metrics_of(scenario, shown) != all_metrics_of(scenario, runs)
    known = {run.name: run.configurations for run in loaded(name, *values).runs}
    truth = {each: true_motion(run, known[each]) for each, run in shown.items()}
    assert all_metrics_of(scenario, truth) == all_metrics_of(scenario, runs)


BAD = {"gain": 1.05, "noise": 0.01, "delay": 2}


def test_metrics_under_a_broken_yaw_rate_sensor():
    """The peak is that of the car, which yaws, not the 0.0 of its sensor."""
    sound = ev_stack.run("double_lane_change").metrics["peak_yaw_rate"].value
    broken = ev_stack.run("double_lane_change", set={"plant.faults": ["constant imu.yaw_rate 0"]})
    assert sound > 0.16  # rad/s, what the line itself asks for: it bends by 1/134 m, at 22.2 m/s
    assert broken.metrics["peak_yaw_rate"].value == sound
    assert not broken.signals["imu.yaw_rate"].any()
    turning = ev_stack.run(
        "dead_motor", set={"plant.faults": ["constant imu.yaw_rate 0"]}, duration=3.0
    )
    assert turning.metrics["fastest_yaw"].value > 0.0


def test_what_was_not_driven_by_these_parts_is_not_known():
    """A sensor's output is not the truth if untouched channels are not those of the car's parts."""
    scenario = loaded("step_steer", ("plant", "faults", ["constant imu.yaw_rate 0"]), duration=5.0)
    run, recording = scenario.runs[0], next(iter(driven(scenario).values()))
    assert struck_channels(run.configurations["plant"]) == {"imu.yaw_rate"}
    moved = {**recording.channels, "pose.x": recording.channels["pose.x"] + 1e-9}
    truth = true_motion(Recording(recording.time, moved), run.configurations)
    found = metrics_of(scenario, {run.name: truth})
    assert found["yaw_rate_gain"] == (
        "not measured: imu.yaw_rate was recorded as its sensor shows it, and what is true is not known"
    )
    assert isinstance(found["lateral_acceleration"], float)


# Sides

# What has a side changes its sign; the rest is the same, with the wheels of the other side.
ODD = (
    "steering_wheel_angle",
    "lateral_acceleration",
    "yaw_rate_after_1_s",
    "yaw_deviation_after_1_s",
)


def image(run: Recording) -> Recording:
    """The recording in the mirror."""
    frames = np.zeros((len(run.time), frame.SIZE))
    frames[:, frame.TIME] = run.time
    places = {name: place for name, place in frame.channels().items() if name in run.channels}
    for name, place in places.items():
        frames[:, place] = run.channels[name]
    seen = mirrored(frames)
    return Recording(
        run.time, {name: np.ascontiguousarray(seen[:, place]) for name, place in places.items()}
    )


def in_the_mirror(name: str, value: float | str, runs: list[str]) -> tuple[str, float | str]:
    run = next(
        (
            each
            for each in sorted(runs, key=len, reverse=True)
            if len(runs) > 1 and name.startswith(each)
        ),
        "",
    )
    rest = name[len(run) :].replace("left", "*").replace("right", "left").replace("*", "right")
    odd = rest.strip("_") in ODD and not isinstance(value, str)
    return run + rest, -value if odd else value


def assert_same(found: dict, wanted: dict, relative: float = 1e-9) -> None:
    assert found.keys() == wanted.keys()
    for name, value in wanted.items():
        assert found[name] == (
            value if isinstance(value, str) else pytest.approx(value, rel=relative, abs=1e-9)
        ), name


@pytest.mark.sampled
@pytest.mark.parametrize("name", DRIVEN)
def test_metrics_of_the_mirror_image_are_mirrored(name):
    """They agree to rounding: sums over wheels have another order."""
    scenario, runs = as_shipped(name)
    assert_mirrored(scenario, runs)


def assert_mirrored(scenario: Scenario, runs: dict[str, Recording]) -> None:
    wanted = dict(
        in_the_mirror(key, value, list(runs))
        for key, value in all_metrics_of(scenario, runs).items()
    )
    assert_same(
        all_metrics_of(scenario, {each: image(run) for each, run in runs.items()}, side=-1.0),
        wanted,
    )


@settings(max_examples=6)
@given(
    st.sampled_from(
        ["step_steer", "double_lane_change", "launch_split_mu", "straight_brake_split_mu"]
    ),
    st.floats(-25.0, 25.0),
    st.sampled_from(["ice", "packed_snow_1", "wet_asphalt_1", "dry_asphalt"]),
    st.sampled_from(["audi_a2", "dissertation_class_b", "layout_1_8_c"]),
)
def test_metrics_of_any_mirror_image_are_mirrored(name, speed, left, vehicle):
    """Both ways, on split friction, with front, rear and all-wheel drive, measured or not."""
    values = [("plant", "initial_speed", speed), ("plant", "road.left", [left])]
    values += [("steering_column", "scale", 1.0)] * (name == "step_steer")  # no slow ramp
    run = load_scenario(name).runs[0].name
    scenario = load_scenario(
        name, Overrides(values=values, duration=2.5, vehicle=vehicle), only=[run]
    )
    assert_mirrored(scenario, driven(scenario))
