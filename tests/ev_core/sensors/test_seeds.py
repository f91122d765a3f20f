"""One seed moves everything random, and each stream is its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ev_stack
from ev_bench.bus.model import BusModelParameters
from ev_bench.machines.described import CanCircuitsParameters
from ev_core.law import group, setting
from ev_core.lockstep.configuration import configure
from ev_core.sensors.random_numbers import seeded
from ev_doors.learning.environment import Environment
from ev_sim.surfaces import RoadParameters, left_and_right

ROAD = RoadParameters(pattern="random")
SEEDS = st.integers(0, 2**31 - 1)
STREAMS = {  # what is random alone, and the channel that shows it
    "road": ({"plant.road.pattern": "random"}, "tire_forces.longitudinal_force.front_left"),
    "sensor": ({"plant.sensors.imu_yaw_rate.noise": 0.1}, "imu.yaw_rate"),
    "drop-out": ({"plant.sensors.wheel_speed.dropout": 0.3}, "wheel_states.velocity.front_left"),
    "noise as a fault": ({"plant.faults": ["noisy imu.yaw_rate 0.1"]}, "imu.yaw_rate"),
    "losses as a fault": (
        {"plant.faults": ["lost wheel_states 0.3"]},
        "wheel_states.velocity.front_left",
    ),
    "order as a fault": (
        {"driver.faults": ["reordered driver/command 0.3"]},
        "driver.command.drive_torque",
    ),
}
PEDALS = {
    "driver.pedals.begin": True,
    "driver.pedals.time": [0.0, 1.0],
    "driver.pedals.brake_torque": [0.0, 0.0],
}
CAR = PEDALS | {"driver.pedals.drive_torque": [200.0, 900.0], "plant.initial_speed": 30.0}


@cache
def driven(stream: str, seed: int | None) -> np.ndarray:
    values, channel = STREAMS[stream]
    result = ev_stack.run(
        "step_steer", runs=("left",), set={**CAR, **values}, seed=seed, duration=1.0
    )
    return next(iter(result.runs.values())).channels[channel]


@pytest.mark.sampled
@pytest.mark.parametrize("stream", STREAMS)
def test_the_seed_moves_each_stream(stream):
    """Two seeds, two runs; no seed means seed 0."""
    one, two, none = (driven(stream, seed).tobytes() for seed in (1, 2, None))
    assert one != two
    assert none == driven(stream, 0).tobytes() != one


def test_the_seed_moves_the_road_of_the_urban_cycle():
    """Its file names the seed of the road.

    The road comes under the wheels of the car that has pulled away.
    """
    first, second, shipped = (
        ev_stack.run("urban_mixed", seed=seed, duration=15.0).hash for seed in (1, 2, None)
    )
    assert len({first, second, shipped}) == 3


def test_the_seed_moves_the_losses_of_a_bus():
    values = {"test_bench.bus.loss": 0.05, "test_bench.inject.kind": "none"}
    lost = [
        next(
            iter(ev_stack.run("bench_fault", set=values, seed=seed, duration=0.1).runs.values())
        ).channels
        for seed in (0, 1)
    ]
    assert lost[0]["can.bus.lost_11"].tobytes() != lost[1]["can.bus.lost_11"].tobytes()


def test_without_a_seed_own_ones_are_as_they_are():
    """No published signal moves.

    What is not random stays the same object, so that a batch prepares it once.
    """
    assert seeded(ROAD, 0) is ROAD
    assert (
        seeded(RoadParameters(), 7) is not None and seeded(RoadParameters(), 7) == RoadParameters()
    )
    assert seeded(BusModelParameters(), 7) == BusModelParameters()
    assert not configure("plant", {"method": "planar"}).has_random_method
    assert configure("plant", {"method": "planar", "road.pattern": "random"}).has_random_method


def test_a_node_shows_the_seed_that_it_was_given():
    """A mixed seed would be mixed twice by a change of another parameter."""
    plant = configure("plant", {"method": "planar", "road.pattern": "random", "seed": 5})
    again = plant.changed({"step": 5e-4})
    assert plant.values()["road.seed"] == again.values()["road.seed"] == 1
    assert again.given.road == plant.given.road != plant.parameters.road


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.sets(SEEDS, min_size=2, max_size=6), SEEDS)
def test_own_seeds_that_follow_are_valid_and_differ(seeds, own):
    """They differ by the node's seed, by their name, and by their own value."""
    bench = CanCircuitsParameters(bus=BusModelParameters(loss=0.1, seed=own))
    road = RoadParameters(pattern="random", seed=own)
    found = [seeded(road, seed).seed for seed in seeds if seed]
    found += [seeded(bench, seed).bus.seed for seed in seeds if seed]
    found += [
        seeded(RoadParameters(pattern="random", seed=own ^ 1), seed).seed for seed in seeds if seed
    ]
    assert len(set(found)) == len(found)
    assert all(0 <= seed < 2**31 for seed in found)


@dataclass(frozen=True, slots=True)
class Dice:
    """A die of one's own."""

    seed: int = setting(1, low=1, high=6, about="where the die begins")


@dataclass(frozen=True, slots=True)
class Player:
    """Parameters of a law with its own seed in a group."""

    die: Dice = group(Dice)


@settings(max_examples=50, derandomize=True, deadline=None)
@given(SEEDS)
def test_an_own_seed_stays_in_its_declared_range(seed):
    """A law may use it as an index."""
    assert 1 <= seeded(Player(), seed).die.seed <= 6


def test_no_two_streams_are_one():
    """Changes between samples of the streams are uncorrelated within four standard errors."""
    shown = {stream: np.diff(driven(stream, 1) - driven(stream, 2)) for stream in STREAMS}
    for one, other in combinations(shown.values(), 2):
        if one.std() and other.std():
            assert abs(np.corrcoef(one, other)[0, 1]) < 4 / np.sqrt(len(one))


def test_roads_of_two_seeds_are_independent():
    """Shares of the distance on which two roads agree.

    0.4^2 + 0.6^2 = 0.52 of 400 segments each, four deviations.
    """
    places = np.arange(0.0, 5000.0, 1.0)
    roads = [left_and_right(seeded(ROAD, seed))[0] for seed in range(8)]
    seen = np.array([[road.at(x) == "packed_snow_1" for x in places] for road in roads])
    for one, other in pairwise(seen):
        assert np.mean(one == other) == pytest.approx(0.52, abs=4 * np.sqrt(0.52 * 0.48 / 180))


def test_batches_are_the_runs_one_by_one_whatever_is_random():
    """Roads, faults and sensors, at four seeds."""
    values = {name: value for given, _ in STREAMS.values() for name, value in given.items()}
    values["plant.faults"] = ["lost wheel_states 0.333 from 0.1", "noisy imu.yaw_rate 0.1"]
    channel = "wheel_states.velocity.front_left"
    changed = {"set": CAR | values, "duration": 0.5}
    found = ev_stack.batch(
        "step_steer", {"*.seed": range(4)}, run="left", signals=(channel,), **changed
    ).signals[channel]
    assert len(np.unique(found, axis=0)) == 4
    for seed in range(4):
        alone = ev_stack.run("step_steer", runs=("left",), seed=seed, **changed)
        assert found[seed].tobytes() == next(iter(alone.runs.values())).channels[channel].tobytes()


def test_a_random_fault_alone_differs_by_seed_in_a_batch():
    """A graph without noise counted as one that no seed moves: three equal runs.

    A third of the messages is lost.
    """
    channel = "wheel_states.velocity.front_left"
    found = ev_stack.batch(
        "double_lane_change",
        {"*.seed": [0, 1, 2]},
        set={"plant.faults": ["lost wheel_states 0.333 from 0.1"]},
        signals=(channel,),
        duration=1.0,
    ).signals[channel]
    for one, other in combinations(found, 2):
        assert np.sum(one != other) > 20  # of 90 samples; the last ones of two seeds may be equal


def test_episodes_of_a_learner_have_other_roads_by_seed_however_large():
    """Gymnasium's seeds are any whole numbers from 0 on."""
    environment = Environment(
        "step_steer", run="left", record=True, set={"plant.road.pattern": "random"}, duration=0.2
    )
    hashes = []
    for seed in (1, 2, 2**31 - 1, 2**31, 2**40, 2**31):
        environment.reset(seed=seed)
        environment.step(np.array([500.0, 500.0]))
        hashes.append(environment.simulation.configurations["plant"].given.road.seed)
    assert len(set(hashes)) == 5
    assert hashes[3] == hashes[5]
