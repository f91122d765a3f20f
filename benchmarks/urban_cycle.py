"""Time of the dissertation's urban cycle offline, by torque control method, beside its plant alone.

    source scripts/setup.sh && python benchmarks/urban_cycle.py [--repeats N] [--json FILE]
    ... --controls [ASR ...]       also with these traction controls in the place of a method; without a name with all
    ... --scenarios NAME ...       also all runs of these scenarios
    ... --duration SECONDS         only the beginning of each run

A cycle has 580 s, the plant steps of 1 ms, control 5 ms. The plant alone runs in the same compiled
loop, its wheels under a constant command; a row is beside the plant of its own run. All rows are
measured in turn in one run, so their ratios hold on a busy machine, too. The JSON has the ratios to
the plant alone as ratio_method_1 to ratio_method_5.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import platform
import time
from pathlib import Path

import numpy as np

from ev_core.lockstep.run import GraphRun, output_again
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, SIZE
from ev_msgs_py.contract.optional_signals import WheelSpeedCommand
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_papers.dissertation.measures.urban_cases import FIVE, METHODS, SCENARIO, case
from ev_stack.recording.offline import graph_run
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.asr_shootout import controls, values_of
from ev_study.studies.study import Case, run_of

DRIVER, SEED = "pulse", 1
# What the plant alone is told; one in speed mode gets a set-point out of reach, with which it is in
# torque mode.
COMMANDS = (
    WheelTorqueCommand(Wheels.front(100.0, 100.0), NO_WHEELS),
    WheelSpeedCommand(Wheels.all(200.0)),
)


def runs(given: argparse.Namespace) -> dict[str, Run]:
    """The runs by the names of their rows."""
    found = {f"method {n}, {METHODS[n].title}": run_of(case(n, DRIVER, SEED)) for n in FIVE}
    named = controls() if given.controls == [] else given.controls or []
    for name in named:
        differential = ("electronic_differential", "method", "equal_torque")
        found[f"asr {name}"] = run_of(Case(name, SCENARIO, (*values_of(name), differential)))
    for name in given.scenarios:
        found |= {f"{name} / {run.name}": run for run in load_scenario(name).runs}
    longest = given.duration
    return {
        name: dataclasses.replace(run, duration=min(run.duration, longest))
        for name, run in found.items()
    }


def plant_of(run: Run) -> str:
    """Name of the row of a run's plant."""
    plant = run.configurations[MASTER]
    return f"{plant.method.name} alone, {plant.common.vehicle.name}, {plant.period / 1e6:g} ms"


def steps_of(run: Run) -> int:
    """Control steps of a run."""
    return stamps.from_seconds(run.duration) // run.configurations[MASTER].period


def time_of_plant(run: Run) -> float:
    """Seconds in which the plant of a run takes as many steps as the run has, under constant commands."""
    plant = run.configurations[MASTER]
    series = np.zeros((SIZE, steps_of(run) + 1))
    for command in COMMANDS:
        if type(command) in plant.method.reads:
            series[PLACES[type(command)]] = np.array(shape_of(type(command)).flat(command))[:, None]
    start = time.perf_counter()
    output_again(plant, series)
    return time.perf_counter() - start


def time_of_cycle(run: Run) -> float:
    """Seconds in which a run takes its steps; what comes before and after does not depend on their number."""
    graph = GraphRun(run.configurations, steps_of(run) + 1)
    start = time.perf_counter()
    graph.drive(lambda time: None, lambda role, text: None)
    return time.perf_counter() - start


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=3, help="the best of so many counts")
    parser.add_argument(
        "--controls",
        nargs="*",
        metavar="ASR",
        choices=controls(),
        help="these, too, or all of them",
    )
    parser.add_argument(
        "--scenarios", nargs="+", default=[], metavar="NAME", help="all runs of these, too"
    )
    parser.add_argument(
        "--duration", type=float, default=580.0, help="longest simulated time of a run [s]"
    )
    arguments = parser.parse_args()
    cycles = runs(arguments)
    plants = {plant_of(run): run for run in cycles.values()}
    for run in cycles.values():
        graph_run(run.configurations, 0.0)
    best: dict[str, float] = {}
    for _ in range(arguments.repeats):
        counts = {name: time_of_plant(run) for name, run in plants.items()}
        counts |= {name: time_of_cycle(run) for name, run in cycles.items()}
        best = {name: min(seconds, best.get(name, seconds)) for name, seconds in counts.items()}
    ratios = {name: best[name] / best[plant_of(run)] for name, run in cycles.items()}
    print(f"{'run':<52}{'s':>8}{'us/step':>10}{'ratio':>8}{'x real time':>13}")
    for name, run in (plants | cycles).items():
        seconds, ratio = best[name], f"{ratios[name]:.2f}" if name in ratios else ""
        print(
            f"{name:<52}{seconds:>8.3f}{seconds / steps_of(run) * 1e6:>10.2f}{ratio:>8}{run.duration / seconds:>13.0f}"
        )
    if arguments.json:
        rows = [
            {"name": name, "seconds": seconds, "ratio": ratios.get(name, 1.0)}
            for name, seconds in best.items()
        ]
        machine = platform.processor() or platform.machine()
        five = {f"ratio_method_{n}": ratios[name] for n, name in zip(FIVE, cycles, strict=False)}
        document = {
            "machine": machine, "python": platform.python_version(), "seconds per": "cycle", **five, "rows": rows
        }  # fmt: skip
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
