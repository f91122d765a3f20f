"""Time of the dissertation's urban cycle offline, by torque control method, beside its plant alone.

    source scripts/setup.sh && python benchmarks/urban_cycle.py [--repeats N] [--json FILE]

A cycle has 580 s, the plant steps of 1 ms, control 5 ms. The plant alone runs in the same compiled loop, its wheels
under a constant command. All rows are measured in turn in one run, so their ratios hold on a busy machine, too. The
JSON has the ratios to the plant alone as ratio_method_1 to ratio_method_5.
"""

from __future__ import annotations

import argparse
import json
import platform
import time
from pathlib import Path

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import PLACES
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.shape import shape_of
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.lockstep.run import GraphRun
from ev_sim.running.offline import run_offline
from ev_sim.running.scenarios.scenario import Run
from ev_sim.study.case import run_of
from ev_sim.study.urban_cases import FIVE, METHODS, case

DRIVER, SEED = "pulse", 1
PLANT = "plant alone"
COMMAND = WheelTorqueCommand(Wheels.front(100.0, 100.0), NO_WHEELS)


def runs() -> dict[str, Run]:
    """The cycle by the name of its row."""
    return {f"method {n}, {METHODS[n].title}": run_of(case(n, DRIVER, SEED)) for n in FIVE}


def steps_of(run: Run) -> int:
    """Control steps of a run."""
    return stamps.from_seconds(run.duration) // run.configurations[MASTER].period


def time_of_plant(run: Run) -> float:
    """Seconds in which the plant of a run takes as many steps as the run has, under constant commands."""
    graph = GraphRun(run.configurations, steps_of(run) + 1)
    graph.frames[:, PLACES[WheelTorqueCommand]] = shape_of(WheelTorqueCommand).flat(COMMAND)
    start = time.perf_counter()
    graph.drive_alone(MASTER)
    return time.perf_counter() - start


def time_of_cycle(run: Run) -> float:
    """Seconds that a run takes."""
    start = time.perf_counter()
    run_offline(run.configurations, run.duration)
    return time.perf_counter() - start


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=3, help="the best of so many counts")
    arguments = parser.parse_args()
    cycles = runs()
    first = next(iter(cycles.values()))
    for run in cycles.values():
        run_offline(run.configurations, 1.0)  # compiles
    best: dict[str, float] = {}
    for _ in range(arguments.repeats):
        counts = {PLANT: time_of_plant(first), **{name: time_of_cycle(run) for name, run in cycles.items()}}
        best = {name: min(seconds, best.get(name, seconds)) for name, seconds in counts.items()}
    print(f"{'one cycle of 580 s':<40}{'s':>8}{'us/step':>10}{'ratio':>8}{'x real time':>13}")
    for name, seconds in best.items():
        per_step, ratio = seconds / steps_of(first) * 1e6, seconds / best[PLANT]
        print(f"{name:<40}{seconds:>8.2f}{per_step:>10.1f}{ratio:>8.1f}{first.duration / seconds:>13.0f}")
    if arguments.json:
        rows = [{"name": name, "seconds": seconds, "ratio": seconds / best[PLANT]} for name, seconds in best.items()]
        machine = platform.processor() or platform.machine()
        ratios = {f"ratio_method_{n}": best[name] / best[PLANT] for n, name in zip(FIVE, cycles, strict=True)}
        document = {
            "machine": machine, "python": platform.python_version(), "seconds per": "cycle", **ratios, "rows": rows
        }  # fmt: skip
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
