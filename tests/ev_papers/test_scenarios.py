"""The scenarios of Ge & Ni, Tatar & Chudzik and Zhileykin.

Closed forms, claims, symmetry and limits.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.ros_graph import graph
from helpers.source_runs import differing, driven, metrics_of, mirrored, value

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.zhileykin2018.shares import turn_arounds
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import load, signal_hash
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

# One run of each scenario with its law, and the steering that mirrors it.
SHORT = {
    "ge_ni2005": ("increment", 0.5, {"profile.angle": (-0.5585053606381855,)}),
    "tatar_chudzik": ("rear_corrected", 17.0, {"profile.angle": (0.0, -5.026548245743669)}),
    "zhileykin2018": ("k1", 6.0, {"profile.angle": (0.0, -1.6755160819145565)}),
}


def short_run(scenario: str, duration: float | None = None, values: dict | None = None) -> Run:
    name, seconds, _ = SHORT[scenario]
    changed = [("steering_column", key, list(value)) for key, value in (values or {}).items()]
    runs = load_scenario(scenario, Overrides(values=changed, duration=duration or seconds)).runs
    return next(run for run in runs if run.name == name)


# Zhileykin 2018


def test_turn_arounds_count_turns_and_not_ways():
    wave = np.sin(np.linspace(0.0, 6 * math.pi, 301))  # three periods: six extremes
    assert turn_arounds(wave, 0.1) == 6
    assert turn_arounds(wave, 2.5) == 0  # no way is that long
    assert turn_arounds(np.linspace(1.0, 0.0, 50), 0.1) == turn_arounds(np.ones(10), 0.0) == 0
    assert turn_arounds(np.array([0.0, 1.0, 0.95, 1.2, 1.0]), 0.1) == 1


def test_rear_drive_spins_and_the_4x4_holds_with_and_without_the_law():
    """The published claim, k = 0.5 that contradicts it, and the control that needs no law."""
    names = ("rear_drive", "k05", "k1", "equality", "fixed_split")
    holds = {name: value("zhileykin2018", f"holds_{name}") for name in names}
    assert holds == {"rear_drive": 0.0, "k05": 0.0, "k1": 1.0, "equality": 1.0, "fixed_split": 1.0}
    assert value("zhileykin2018", "peak_sideslip_fixed_split") < value(
        "zhileykin2018", "peak_sideslip_k1"
    )


def test_shares_of_the_law_do_not_oscillate_with_k_1():
    for share in ("h_n", "h_2", "h_4"):
        assert value("zhileykin2018", f"turn_arounds_{share}_k1") <= 1.0
    assert value("zhileykin2018", "turn_arounds_h_n_k05") > 1.0


# All scenarios


@pytest.mark.parametrize("scenario", SHORT)
def test_every_metric_of_the_sources_is_measured(scenario):
    assert [name for name, metric in metrics_of(scenario).items() if metric.value is None] == []


@pytest.mark.parametrize("scenario", SHORT)
def test_right_turn_mirrors_the_left_one_to_the_bit(scenario):
    left = short_run(scenario)
    right = short_run(scenario, values=SHORT[scenario][2])
    there = run_offline(left.configurations, left.duration)
    back = mirrored(run_offline(right.configurations, right.duration))
    assert np.abs(there.channels["imu.yaw_rate"]).max() > 0.01
    assert differing(there, back) == []


@pytest.mark.parametrize("scenario", SHORT)
def test_requests_stay_within_what_the_driver_asks_and_the_motors_can(scenario):
    """The stated difference is slip_target's largest correction.

    All other laws only share the driver's torque out.
    """
    for run in driven(scenario).scenario.runs:
        channels = driven(scenario).runs[run.name].channels
        law = run.configurations["electronic_differential"]
        added = (
            law.values().get("largest_correction", 0.0) if law.method.name == "slip_target" else 0.0
        )
        asked = channels["driver.command.drive_torque"]
        total = sum(channels[f"torque_request.drive.{wheel}"] for wheel in WHEEL_NAMES)
        assert (total <= (1 + added) * asked + 1e-9 * np.abs(asked)).all(), run.name
        car = run.configurations["plant"].common.vehicle
        shared = 1 if car.driveline.coupling == "individual" else len(car.driven_wheels)
        limit = car.motor.peak_torque * car.gear_ratio * shared
        for wheel in WHEEL_NAMES:
            request = channels[f"torque_request.drive.{wheel}"]
            assert (np.abs(request) <= (limit if wheel in car.driven_wheels else 0.0)).all(), (
                run.name,
                wheel,
            )


@pytest.mark.parametrize("scenario", SHORT)
def test_offline_and_over_dds_give_the_same_hash(scenario, tmp_path):
    run = short_run(scenario, duration=0.2)
    with graph(run, tmp_path) as nodes:
        nodes.run()
    assert signal_hash(load(tmp_path / "signals.npz")) == signal_hash(
        run_offline(run.configurations, run.duration)
    )
