"""python tools/coverage_of_intervals.py [--seeds N]: how often an identification's intervals hold the truth.

A simulated car is driven through a manoeuvre of each seed, its yaw rate and lateral velocity get noise, and parameters
are identified as by scripts/run.sh identify from two thirds of it, begun off. The result stands in docs/measured.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.vehicle.tyre import MF_NAMES
from ev_sim.measured.free_parameters import free_parameters
from ev_sim.measured.identification import identify
from ev_sim.measured.intervals import knowledge
from ev_sim.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_sim.measured.replays.open_loop import OpenLoop, graph, windows_of
from ev_sim.recording.offline import run_offline
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Overrides

CAR, PERIOD, OFF = "compact_ev", 0.01, 1.2
FREE = ("vehicle.yaw_inertia", "vehicle.tyre.front_mf.pky1", "steering_column.offset")
NOISE = {YAW_RATE: 0.01, LATERAL: 0.01}  # rad/s, m/s


def main(argv: Sequence[str] | None = None) -> None:
    """Print by seed which parameters were held, and the shares of all seeds."""
    parser = argparse.ArgumentParser(prog="coverage_of_intervals.py", description=__doc__)
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="default 100")
    parser.add_argument("--duration", type=float, default=30.0, metavar="S", help="of each record; default 30 s")
    parser.add_argument("--window", type=float, default=5.0, metavar="S", help="default 5 s")
    given = parser.parse_args(argv)
    vehicle = graph(CAR, PERIOD)["plant"].common.vehicle
    truth = np.array([vehicle.yaw_inertia, vehicle.tyre.front_mf[MF_NAMES.index("pky1")], 0.0])
    begun = graph(CAR, PERIOD, Overrides(values=[("*", "vehicle.yaw_inertia", OFF * vehicle.yaw_inertia)]))
    held = []
    for seed in range(given.seeds):
        intervals = identified(record_of(seed, given.duration), begun, given.window)
        held.append((intervals[:, 0] <= truth) & (truth <= intervals[:, 1]))
        print(seed, *("held" if each else "missed" for each in held[-1]), flush=True)
    for name, count in zip(FREE, np.sum(held, axis=0), strict=True):
        print(f"{name}: held by {count} of {given.seeds} intervals")


def driven(random: np.random.Generator, duration: float) -> Recording:
    """The car at 18 to 22 m/s, steered by three sines of up to 2 deg together: up to 5 m/s^2, far from any limit."""
    time = np.arange(round(duration / PERIOD) + 2) * PERIOD
    phases = random.uniform(0.0, 2.0 * np.pi, 3)
    angle = sum(np.radians(0.7) * np.sin(f * time + at) for f, at in zip((0.8, 2.1, 5.0), phases, strict=True))
    speed = 20.0 + 2.0 * np.sin(0.4 * time + phases[0])
    values = [
        ("plant", "initial_speed", float(speed[0])),
        ("plant", "initial_hold", 0.0),
        ("plant", "imposed_speed.time", time.tolist()),
        ("plant", "imposed_speed.speed", speed.tolist()),
        ("steering_column", "time", time.tolist()),
        ("steering_column", "angle", np.asarray(angle).tolist()),
    ]
    return run_offline(graph(CAR, PERIOD, Overrides(values=values)), duration)


def record_of(seed: int, duration: float) -> MeasuredRecord:
    """What is measured of the car, with noise."""
    random = np.random.Generator(np.random.PCG64(seed))
    run = driven(random, duration)
    columns = {}
    for name in (LONGITUDINAL, LATERAL, YAW_RATE, ROAD_WHEEL_ANGLE):
        noise = NOISE.get(name, 0.0) * random.standard_normal(len(run.time))
        columns[name] = (Sampled(run.time, run.channels[name] + noise), ColumnParameters())
    return measured(f"seed {seed}", "", columns, MaskParameters())


def identified(record: MeasuredRecord, begun: dict[str, Configuration], window: float) -> np.ndarray:
    """The intervals of the parameters, (parameters, 2), from two thirds of a record."""
    replay = OpenLoop(record, windows_of(record, window, 0.0, 2.0 / 3.0), begun, (LATERAL, YAW_RATE))
    free = free_parameters(FREE, begun)
    fitted = identify(replay, free, (YAW_RATE, SIDESLIP), every=5, width=1.0, starts=1, seed=0, most=8)
    return knowledge(fitted.residuals, fitted.derivatives, fitted.values, free, 1.0, 0).interval


if __name__ == "__main__":
    main()
