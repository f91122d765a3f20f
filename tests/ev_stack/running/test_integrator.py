"""The semi-implicit integrator in all ways of running: equal bits, and other ones than by default."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest

import ev_stack
from documentation.processors import hash_on
from ev_doors.export.targets import TARGETS
from ev_doors.learning.environment import Environment
from ev_stack.commands.program import perform
from ev_stack.interface.simulation import Simulation
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import load, signal_hash
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

SCENARIO = "double_lane_change"
CHOSEN = {"plant.integrator": "semi_implicit"}


@pytest.fixture(scope="module")
def run() -> Run:
    """A second of the lane change."""
    values = [("plant", "integrator", "semi_implicit")]
    return load_scenario(SCENARIO, Overrides(values=values, duration=1.0)).runs[0]


@pytest.fixture(scope="module")
def plain(run) -> str:
    return signal_hash(run_offline(run.configurations, run.duration))


def test_a_run_has_its_hash_and_its_name_in_the_summary(plain, tmp_path):
    chosen = ev_stack.run(SCENARIO, set=CHOSEN, duration=1.0)
    assert chosen.hash == plain != ev_stack.run(SCENARIO, duration=1.0).hash
    folder = chosen.save(tmp_path / "chosen")
    assert '"integrator": "semi_implicit"' in (folder / "summary.json").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "way", [run_in_process, pytest.param(run_in_processes, marks=pytest.mark.weekly)]
)
def test_nodes_have_the_hash(way, run, plain, tmp_path):
    way(run, tmp_path, False, lambda time: None)
    assert signal_hash(load(tmp_path / "signals.npz")) == plain


def test_a_batch_drives_both_integrators():
    """Each run as alone, though they differ in their compiled code."""
    both = {"plant.integrator": ["runge_kutta", "semi_implicit"]}
    found = ev_stack.batch(SCENARIO, both, duration=1.0, metrics=["peak_sideslip"])
    alone = [
        ev_stack.run(SCENARIO, set=each, duration=1.0, metrics=["peak_sideslip"])
        for each in ({}, CHOSEN)
    ]
    expected = [each.metrics["peak_sideslip"].value for each in alone]
    assert found.metrics["peak_sideslip"].tolist() == expected
    assert expected[0] != expected[1]


def test_a_simulation_goes_on_from_its_state():
    """The rates that lead to the next step are part of it."""
    first, second = (Simulation(SCENARIO, set=CHOSEN) for _ in range(2))
    for _ in range(250):
        first.step()
    second.state = first.state
    for _ in range(30):
        assert dict(first.step()) == dict(second.step())


def test_an_agent_drives_it():
    """The command of the law as the action gives the signals of the run."""
    environment = Environment(SCENARIO, observe=["imu.yaw_rate"], set=CHOSEN, duration=1.0)
    _, info = environment.reset(seed=0)
    seen = []
    for _ in range(100):
        observed, *_, info = environment.step(info["own"])
        seen.append(observed[0])
    channels = ev_stack.run(SCENARIO, set=CHOSEN, duration=1.0, seed=0).runs
    (recording,) = channels.values()
    assert seen == recording.channels["imu.yaw_rate"][1:].tolist()


@pytest.mark.slow
@pytest.mark.weekly  # compiles the plant for C once more
def test_exported_it_has_the_same_bits(run, plain, tmp_path):
    """The C library in a program of its own, and the FMU."""
    assert hash_on(run, TARGETS["x86_64-linux"], tmp_path) == plain
    file = tmp_path / "car.fmu"
    words = [SCENARIO, "--set", "plant.integrator=semi_implicit", "--duration", "1"]
    perform(["fmu", *words, "--out", str(file), "--target", "x86_64-linux"])
    simulated = fmpy.simulate_fmu(
        str(file), stop_time=1.0, step_size=0.01, output_interval=0.01, output=["imu.yaw_rate"]
    )
    rates = run_offline(run.configurations, run.duration).channels["imu.yaw_rate"]
    assert rates.any()
    assert np.array_equal(simulated["imu.yaw_rate"][: len(rates)], rates)
