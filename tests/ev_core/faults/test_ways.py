"""Several faults in one graph.

The same bits in all ways of running, whatever the network loses besides.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from helpers.fake_network import FakeNetwork, Faults

from ev_core.lockstep.configuration import Configuration
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

FAULTS = {
    "plant": [
        "motor_share front_left 0 from 0.4",
        "puncture rear_right 1 from 0.2",
        "inverter_delay front_right 0.03",
        "noisy imu 0.1",
        "swapped wheel_states.velocity.front_left,wheel_states.velocity.front_right from 0.5",
        "delayed twist 0.05 from 0.3",
        "lost battery 0.2",
    ],
    "steering_column": [
        "offset steering_column/state.angle 0.05",
        "reordered steering_column/state 0.3",
    ],
    "driver": ["lost driver/command 0.2"],
    "electronic_differential": ["restarted torque_request from 0.5 until 0.7"],
    "asr": ["scaled torque_command.drive 0.9 from 0.6"],
}
# its integral is what a restart forgets
LAW = ("electronic_differential", "method", "steer_by_wire")
COLUMN = ("steering_column", "method", "by_wire")


def run(faults: dict[str, list[str]], seed: int = 3) -> Run:
    values = [
        LAW,
        COLUMN,
        ("*", "seed", seed),
        *((role, "faults", texts) for role, texts in faults.items()),
    ]
    return load_scenario("double_lane_change", Overrides(values=values, duration=1.0)).runs[0]


@cache
def driven(seed: int = 3, *roles: str) -> Recording:
    chosen = run({role: FAULTS[role] for role in roles or FAULTS}, seed)
    return run_offline(dict(chosen.configurations), chosen.duration)


def configurations() -> dict[str, Configuration]:
    return dict(run(FAULTS).configurations)


def test_the_seed_alone_decides():
    chosen = run(FAULTS)
    again = run_offline(dict(chosen.configurations), chosen.duration)
    assert signal_hash(again) == signal_hash(driven()) != signal_hash(driven(4))


def test_each_role_feels_its_faults():
    """Every number is finite, and each role's faults change the run."""
    sound = run_offline(dict(run({}).configurations), 1.0)
    hashes = {signal_hash(driven(3, role)) for role in FAULTS} | {signal_hash(sound)}
    assert len(hashes) == 1 + len(FAULTS)
    assert all(np.isfinite(column).all() for column in driven().channels.values())


def test_a_restart_keeps_the_last_answer_and_then_forgets():
    """The request holds from 0.5 s to 0.7 s; then the law's integral is that of its first step."""
    asked = driven(3, "electronic_differential").channels["torque_request.drive.front_left"]
    sound = run_offline(dict(run({}).configurations), 1.0).channels[
        "torque_request.drive.front_left"
    ]
    assert (asked[50:70] == asked[49]).all() and (asked[:50] == sound[:50]).all()
    assert asked[70] != asked[69]


def test_a_network_that_loses_messages_changes_nothing():
    """Losses and repetitions of the transport are made good by lockstep.

    The losses that are declared are not.
    """
    network = FakeNetwork(configurations(), 100, seed=1, faults=Faults(0.1, 0.1, 0.001))
    network.begin()
    network.run()
    assert network.signals() == {
        name: [float.hex(number) for number in column.tolist()]
        for name, column in driven().channels.items()
    }


def test_a_recorded_driver_has_faults_too(tmp_path):
    """Offline and as nodes, where each fault is put in behind what was recorded."""
    file = tmp_path / "driver.npz"
    np.savez(file, time=driven().time, **driven().channels)
    values = [
        ("*", "seed", 3),
        ("driver", "method", str(file)),
        ("driver", "faults", ["scaled driver/command 0.5"]),
    ]
    chosen = load_scenario("double_lane_change", Overrides(values=values, duration=1.0)).runs[0]
    network = FakeNetwork(dict(chosen.configurations), 100, seed=1)
    network.begin()
    network.run()
    offline = run_offline(dict(chosen.configurations), 1.0).channels
    assert network.signals() == {
        name: [float.hex(number) for number in column.tolist()] for name, column in offline.items()
    }
    torque = "driver.command.drive_torque"
    assert (offline[torque] == driven().channels[torque] * 0.5).all() and offline[torque].any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "way", ["one process", pytest.param("processes", marks=pytest.mark.weekly)]
)
def test_over_dds_the_same_hash(way, tmp_path):
    chosen = run(FAULTS)
    if way == "processes":
        outcome = run_in_processes(chosen, tmp_path, False, lambda time: None, {})
    else:
        outcome = run_in_process(chosen, tmp_path, False, lambda time: None)
    assert signal_hash(outcome.recording) == signal_hash(driven())
