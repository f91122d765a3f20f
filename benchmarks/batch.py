"""A thousand double lane changes in one call on all cores, beside the plant alone, measured in one run.

    python benchmarks/batch.py [--json FILE] [--runs N] [--rounds N]

Each run has 10 s with a speed and a seed of its own, and noise in what the driver reads: driver,
steering column, laws and sensors every 10 ms, the plant every 1 ms. The plant alone is one object
that is advanced over seconds at a time, with fixed torques and wheels: nothing but its fused loop,
on one core. Cores that share caches or execution units do not do as much together as each of them
alone: the loop is measured on all cores at once, too, and `share_of_loops_at_once` is what the
batch reaches of that.

Shares are of rates per second of processor time, in alternating rounds (`rounds`), so that they hold
on a busy machine; that a core waits for the last run does not count in them. Times and rates of the
whole graph are by the clock.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from rounds import alternating, as_json, machine, ratio_of

from ev_core.compiled.part import CompiledPart
from ev_core.compiling.machine_code import call
from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_stack.batches.batch import batch
from ev_stack.batches.observer import largest_magnitude, root_mean_square
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.scenario import load_scenario

DURATION = 10.0  # [s]
GOAL = 0.85  # share of the fused loop
FUSED_STEPS, FUSED_SECONDS = 3000, 1.0
SENSORS = {"body_velocity": 0.05, "imu_yaw_rate": 0.002}  # noise [m/s], [rad/s]
METRICS = {
    "lateral_velocity": largest_magnitude("twist.lateral"),
    "lateral_acceleration": largest_magnitude("imu.lateral_acceleration"),
    "yaw_rate": root_mean_square("twist.yaw_rate"),
}


def fused_loop_rate(plant: Configuration) -> float:
    """Steps of the plant alone per second of processor time."""
    step = plant.parameters.step
    part = CompiledPart(plant.method, plant.parameters, plant.common.vehicle, FUSED_STEPS * step)
    now, then = np.zeros(frame.SIZE), np.zeros(frame.SIZE)
    now[frame.PLACES[WheelTorqueCommand]][:2] = 120.0
    now[frame.PLACES[SteeringColumnState]] = 0.0, 0.0, 0.0, 0.02, 0.0
    function, state, constants = part.addresses()
    start, steps, begin = part.state.copy(), 0, time.thread_time()
    while (seconds := time.thread_time() - begin) < FUSED_SECONDS:
        part.state[:] = start
        call(function, now.ctypes.data, then.ctypes.data, state, constants)
        steps += FUSED_STEPS
    return steps / seconds


def loops_at_once_rate(plant: Configuration, cores: int) -> float:
    """Steps of as many plants as cores, together, in a second of processor time of all cores."""
    with ThreadPoolExecutor(cores) as pool:
        return sum(pool.map(fused_loop_rate, [plant] * cores))


def main() -> None:
    """Print both rates and their ratio and, if asked for, write them as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the result to this file")
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    cores = len(os.sched_getaffinity(0))
    values = [(MASTER, f"sensors.{name}.noise", noise) for name, noise in SENSORS.items()]
    configurations = (
        load_scenario("double_lane_change", Overrides(values=values)).runs[0].configurations
    )
    plant = configurations[MASTER]

    steps = given.runs * DURATION / plant.parameters.step

    seconds = []

    def batch_rate() -> float:
        """Steps of all cars in a second of processor time of all cores."""
        vary = {
            "plant.initial_speed": np.linspace(18.0, 23.0, given.runs),
            "*.seed": range(given.runs),
        }
        begin, used = time.perf_counter(), time.process_time()
        failed = batch(
            configurations, DURATION, vary, signals=("pose.y",), every=10, metrics=METRICS
        ).failed
        assert not failed, failed
        seconds.append(time.perf_counter() - begin)
        return cores * steps / (time.process_time() - used)

    measures = {
        "alone": partial(fused_loop_rate, plant),
        "at once": partial(loops_at_once_rate, plant, cores),
        "batch": batch_rate,
    }
    rates = alternating(measures, given.rounds)
    alone, at_once, _ = map(statistics.median, rates.values())
    share = ratio_of(rates["batch"], [cores * each for each in rates["alone"]], GOAL)
    share_at_once = ratio_of(rates["batch"], rates["at once"])
    took = statistics.median(seconds[1:])  # the first one compiles
    rate = steps / took
    print(f"{given.runs} double lane changes of {DURATION:g} s on {cores} cores   {took:.2f} s")
    print(f"whole graph   {rate:12.0f} car steps of 1 ms per second")
    print(f"plant alone   {alone:12.0f} on one core")
    print(f"plants        {at_once:12.0f} on all cores at once")
    print(f"share of the fused loop {share}")
    print(f"share of the loops at once {share_at_once}")
    if given.json:
        document = {
            **machine(),
            "cores": cores,
            "runs": given.runs,
            "seconds": took,
            "car_steps_per_second": rate,
            "fused_loop_steps_per_second": alone,
            "loops_at_once_steps_per_second": at_once,
            "share_of_fused_loop": as_json(share),
            "share_of_loops_at_once": as_json(share_at_once),
        }
        given.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
