"""python tools/coverage_of_intervals.py [GROUP ...] [--seeds N]: how often identified intervals hold the truth.

A simulated car is driven through a manoeuvre of each seed. All that is imposed and all that is
compared gets noise, and each group of parameters is identified as by scripts/run.sh identify from
two thirds of the record, begun off. An interval that a fit does not support is none, and is counted
beside. The result stands in docs/measured.md.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Overrides
from ev_study.measured.free_parameters import GROUPS, FreeParameter, free_parameters
from ev_study.measured.identification import identify
from ev_study.measured.identified import Identified
from ev_study.measured.intervals import knowledge
from ev_study.measured.records.record import (
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
from ev_study.measured.replays.open_loop import OpenLoop, graph, windows_of

CAR, CAR_WITH_CURVE, PERIOD, OFF = "compact_ev", "audi_a2", 0.01, 1.1
# m/s, m/s, rad/s, rad
NOISE = {LONGITUDINAL: 0.05, LATERAL: 0.05, YAW_RATE: 0.01, ROAD_WHEEL_ANGLE: 0.0005}
PART = "training"


def main(argv: Sequence[str] | None = None) -> None:
    """Print by parameter how many intervals of all seeds hold the truth, and how many fits give none."""
    parser = argparse.ArgumentParser(prog="coverage_of_intervals.py", description=__doc__)
    parser.add_argument(
        "groups", nargs="*", metavar="GROUP", help=f"default all: {', '.join(GROUPS)}"
    )
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="default 100")
    parser.add_argument(
        "--duration", type=float, default=30.0, metavar="S", help="of each record; default 30 s"
    )
    parser.add_argument("--window", type=float, default=5.0, metavar="S", help="default 5 s")
    given = parser.parse_args(argv)
    print("group, parameter: intervals that hold the truth, of those given")
    for group in given.groups or GROUPS:
        counted(group, given.seeds, given.duration, given.window)


def counted(group: str, seeds: int, duration: float, window: float) -> np.ndarray:
    """How many intervals of some seeds hold the truth, and how many are given, (2, parameters); printed as well."""
    car = CAR_WITH_CURVE if group == "curve" else CAR
    true = graph(car, PERIOD)
    truth = free_parameters([group], true)
    begun = _off(truth, car, true)
    counts = np.zeros((2, len(truth)), int)
    values = np.array([each.start for each in truth])
    for seed in range(seeds):
        intervals = identified(record_of(seed, duration, car), begun, window, group)
        counts += [
            (intervals[:, 0] <= values) & (values <= intervals[:, 1]),
            np.isfinite(intervals[:, 0]),
        ]
        if sys.stderr.isatty() or seed % 10 == 9:
            print(
                f"{group}: {counts[0].tolist()} of {counts[1].tolist()} in {seed + 1}",
                file=sys.stderr,
                flush=True,
            )
    for each, held, given in zip(truth, *counts, strict=True):
        print(f"{group}, {each.name}: {held} of {given} ({seeds} seeds)", flush=True)
    return counts


def _off(
    truth: Sequence[FreeParameter], car: str, true: Mapping[str, Configuration]
) -> dict[str, Configuration]:
    """The car that a fit begins with: each free number a tenth off, as far as its range allows."""
    values: dict[tuple[str, str], object] = {}
    for each in truth:
        number = min(OFF * each.start, each.high)
        role, _, key = each.array.partition(".")
        node, key = ("*", each.array) if each.is_of_vehicle else (role, key)
        if each.place < 0:
            values[node, key] = number
            continue
        given = dict(true["plant"].values())[each.array]
        array = values.setdefault((node, key), list(given))
        array[each.place] = number  # type: ignore[index]
    return graph(car, PERIOD, Overrides(values=[(*at, value) for at, value in values.items()]))


def driven(random: np.random.Generator, duration: float, car: str = CAR) -> Recording:
    """The car at 18 to 22 m/s, steered by three sines of up to 2 deg together: up to 5 m/s^2, far from any limit."""
    time = np.arange(round(duration / PERIOD) + 2) * PERIOD
    phases = random.uniform(0.0, 2.0 * np.pi, 3)
    angle = sum(
        np.radians(0.7) * np.sin(f * time + at)
        for f, at in zip((0.8, 2.1, 5.0), phases, strict=True)
    )
    speed = 20.0 + 2.0 * np.sin(0.4 * time + phases[0])
    values = [
        ("plant", "initial_speed", float(speed[0])),
        ("plant", "initial_hold", 0.0),
        ("plant", "imposed_speed.time", time.tolist()),
        ("plant", "imposed_speed.speed", speed.tolist()),
        ("steering_column", "time", time.tolist()),
        ("steering_column", "angle", np.asarray(angle).tolist()),
    ]
    return run_offline(graph(car, PERIOD, Overrides(values=values)), duration)


def record_of(seed: int, duration: float, car: str = CAR) -> MeasuredRecord:
    """What is measured of the car, with noise on all of it."""
    random = np.random.Generator(np.random.PCG64(seed))
    run = driven(random, duration, car)
    columns = {}
    for name, deviation in NOISE.items():
        noise = deviation * random.standard_normal(len(run.time))
        columns[name] = (Sampled(run.time, run.channels[name] + noise), ColumnParameters())
    return measured(f"seed {seed}", "", columns, MaskParameters())


def identified(
    record: MeasuredRecord, begun: dict[str, Configuration], window: float, group: str
) -> np.ndarray:
    """The intervals of the parameters, (parameters, 2), from two thirds of a record; NaN where none is supported."""
    replay = OpenLoop(
        record, windows_of(record, window, 0.0, 2.0 / 3.0), begun, (LATERAL, YAW_RATE)
    )
    free = free_parameters([group], begun)
    fitted = identify(
        replay, free, (YAW_RATE, SIDESLIP), every=5, width=1.0, starts=1, seed=0, most=25
    )
    known = knowledge(fitted.residuals, fitted.derivatives, fitted.values, free, 1.0, 0)
    return Identified(free, fitted, known, {PART: replay}, {}, {}, "").intervals


if __name__ == "__main__":
    main()
