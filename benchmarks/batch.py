"""A thousand double lane changes in one call on all cores, beside the plant alone, measured in one run.

    python benchmarks/batch.py [--json FILE] [--runs N] [--rounds N]

Each run has 10 s with a speed and a seed of its own, and noise in what the driver reads: driver,
steering column, laws and sensors every 10 ms, the plant every 1 ms. The plant alone is one object
that is advanced over seconds at a time, with fixed torques and wheels: nothing but its fused loop,
on one core. Cores that share caches or execution units do not do as much together as each of them
alone: the loop is measured on all cores at once, too, and `share_of_loops_at_once` is what the
batch reaches of that.

Each rate is what was done in the whole time that it took. One round measures all of them, one
behind the other, because a machine does not keep its speed; the figures are medians over the
rounds, the shares those of the ratios in one round.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

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
FUSED_STEPS, FUSED_SECONDS = 3000, 1.0
SENSORS = {"body_velocity": 0.05, "imu_yaw_rate": 0.002}  # noise [m/s], [rad/s]
METRICS = {
    "lateral_velocity": largest_magnitude("twist.lateral"),
    "lateral_acceleration": largest_magnitude("imu.lateral_acceleration"),
    "yaw_rate": root_mean_square("twist.yaw_rate"),
}


def fused_loop_rate(plant: Configuration) -> float:
    """Steps per second of the plant alone on one core."""
    step = plant.parameters.step
    part = CompiledPart(plant.method, plant.parameters, plant.common.vehicle, FUSED_STEPS * step)
    now, then = np.zeros(frame.SIZE), np.zeros(frame.SIZE)
    now[frame.PLACES[WheelTorqueCommand]][:2] = 120.0
    now[frame.PLACES[SteeringColumnState]] = 0.0, 0.0, 0.0, 0.02, 0.0
    function, state, constants = part.addresses()
    start, steps, begin = part.state.copy(), 0, time.perf_counter()
    while (seconds := time.perf_counter() - begin) < FUSED_SECONDS:
        part.state[:] = start
        call(function, now.ctypes.data, then.ctypes.data, state, constants)
        steps += FUSED_STEPS
    return steps / seconds


def loops_at_once_rate(plant: Configuration, cores: int) -> float:
    """Steps per second of as many plants as cores, together."""
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

    def drive(runs: int) -> float:
        """Seconds that it takes."""
        vary = {"plant.initial_speed": np.linspace(18.0, 23.0, runs), "*.seed": range(runs)}
        begin = time.perf_counter()
        failed = batch(
            configurations, DURATION, vary, signals=("pose.y",), every=10, metrics=METRICS
        ).failed
        assert not failed, failed
        return time.perf_counter() - begin

    drive(cores)  # compiles
    rounds = [
        (fused_loop_rate(plant), loops_at_once_rate(plant, cores), drive(given.runs))
        for _ in range(given.rounds)
    ]
    alone, at_once, seconds = map(statistics.median, zip(*rounds, strict=True))
    steps = given.runs * DURATION / plant.parameters.step
    shares = [steps / took / (cores * one) for one, _, took in rounds]
    share, share_at_once = (
        statistics.median(shares),
        statistics.median(steps / took / all_ for _, all_, took in rounds),
    )
    rate = steps / seconds
    print(f"{given.runs} double lane changes of {DURATION:g} s on {cores} cores   {seconds:.2f} s")
    print(f"whole graph   {rate:12.0f} car steps of 1 ms per second")
    print(f"plant alone   {alone:12.0f} on one core")
    print(f"plants        {at_once:12.0f} on all cores at once")
    print(f"share of the fused loop {share:.2f} ({min(shares):.2f} to {max(shares):.2f} by round)")
    print(f"share of the loops at once {share_at_once:.2f}")
    if given.json:
        document = {
            "machine": platform.processor() or platform.machine(),
            "python": platform.python_version(),
            "cores": cores,
            "runs": given.runs,
            "seconds": seconds,
            "car_steps_per_second": rate,
            "fused_loop_steps_per_second": alone,
            "share_of_fused_loop": share,
            "shares_by_round": shares,
            "loops_at_once_steps_per_second": at_once,
            "share_of_loops_at_once": share_at_once,
        }
        given.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
