"""A step of a car in a vector of environments, beside the plain compiled loop and a single environment.

    python benchmarks/vector.py [--json FILE] [--cars N] [--steps N] [--rounds N] [--memory N]

Double lane changes of `ev_stack/TorqueSplit-v0`: every 10 ms driver, column, laws and the plant's
ten steps. The plain loop is a batch of whole runs, which keeps nothing: the graph without a
learner. The vector observes, rewards, and lets the scenario's law answer beside the learner's action.

Ratios are by processor time of all cores, in alternating rounds (`rounds`). The rate of all cores is
by the clock. With `--memory` so many cars are made, and the process's memory is printed before and
behind further steps, in which every car begins a new episode.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import time
from functools import partial
from pathlib import Path

import gymnasium
import numpy as np
from rounds import alternating, as_json, machine, processor_time, ratio_of

import ev_doors.learning  # noqa: F401, registers the environments
from ev_msgs_py.contract import stamps
from ev_stack.batches.batch import batch

NAME = "ev_stack/TorqueSplit-v0"
TORQUE = 50.0  # [N m] at each wheel
KEPT = Path("/proc/self/statm")


def vector_of(cars: int, **changes: object) -> gymnasium.vector.VectorEnv:
    """Cars at their start."""
    made = gymnasium.make_vec(
        NAME, num_envs=cars, vectorization_mode="vector_entry_point", **changes
    )
    made.reset(seed=1)
    return made


def steps_of(environment: gymnasium.Env | gymnasium.vector.VectorEnv, steps: int) -> None:
    """Step with one action."""
    action = np.full(environment.action_space.shape, TORQUE)
    for _ in range(steps):
        environment.step(action)


def memory() -> float:
    """Memory of the process [MB]."""
    pages = int(KEPT.read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def print_memory(cars: int, steps: int) -> None:
    """Print the memory of many cars, over episodes that end in every tenth step."""
    before = memory()
    vector = vector_of(cars, duration=0.09)
    made = memory()
    rows = [made]
    for _ in range(5):
        steps_of(vector, max(steps // 5, 11))
        rows.append(memory())
    listed = " ".join(f"{each:.0f}" for each in rows)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    print(
        f"{cars} cars: {1e3 * (made - before) / cars:.1f} kB each; process {listed} MB, peak {peak:.0f}"
    )


def main() -> None:
    """Print times and ratios and, if asked for, write them as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the result to this file")
    parser.add_argument("--cars", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=50, help="of each car in a round")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--memory", type=int, default=0, help="cars whose memory is printed")
    given = parser.parse_args()
    if given.memory:
        print_memory(given.memory, given.steps)
        return
    vector, single = vector_of(given.cars), gymnasium.make(NAME, disable_env_checker=True)
    single.reset(seed=1)
    graph = single.unwrapped.simulation
    # Whole runs, so that making them does not count; as many as have the steps of the cars.
    periods = round(graph.duration / graph.period * stamps.NANOSECONDS)
    runs = max(given.cars * given.steps // periods, 1)
    seeds = {"*.seed": range(runs)}
    seconds: list[float] = []

    def in_vector() -> float:
        begin = time.perf_counter()
        used = processor_time(partial(steps_of, vector, given.steps))
        seconds.append((time.perf_counter() - begin) / given.steps / given.cars)
        return used / given.steps / given.cars

    def in_loop() -> float:
        drive = partial(batch, graph.configurations, graph.duration, seeds)
        return processor_time(drive) / runs / periods

    def alone() -> float:
        single.reset(seed=1)
        return processor_time(partial(steps_of, single, given.steps)) / given.steps

    rounds = alternating({"loop": in_loop, "vector": in_vector, "single": alone}, given.rounds)
    over_loop = ratio_of(rounds["vector"], rounds["loop"])
    single_over = ratio_of(rounds["single"], rounds["vector"])
    rate = 1.0 / statistics.median(rounds["vector"])
    cores = len(os.sched_getaffinity(0))
    of_all = 1.0 / statistics.median(seconds[1:])  # the first one compiles
    for name, row in rounds.items():
        print(f"{name:<8}{1e6 * statistics.median(row):8.2f} us of a core for a step of a car")
    print(f"{rate:.0f} steps a second and core, {of_all:.0f} a second on {cores} cores")
    print(f"vector over plain loop {over_loop}")
    print(f"single environment over vector {single_over}")
    if given.json:
        document = {
            **machine(),
            "cars": given.cars,
            "cores": cores,
            "seconds": {name: statistics.median(row) for name, row in rounds.items()},
            "steps_per_second_and_core": rate,
            "steps_per_second": of_all,
            "over_plain_loop": as_json(over_loop),
            "single_over_vector": as_json(single_over),
        }
        given.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
