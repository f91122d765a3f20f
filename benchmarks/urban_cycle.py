"""Time of the dissertation's urban cycle offline, by torque control method, beside its plant alone.

    source scripts/setup.sh && python benchmarks/urban_cycle.py [--repeats N] [--json FILE]
    ... --controls [ASR ...]       also with these traction controls in the place of a method; without a name with all
    ... --scenarios NAME ...       also all runs of these scenarios
    ... --duration SECONDS         only the beginning of each run

A cycle has 580 s, the plant steps of 1 ms, control 5 ms. The plant alone runs in the same compiled
loop, its wheels under a constant command. It is measured before each run anew, by processor time
(`rounds`), so that the ratios hold on a busy machine. The JSON has those to the plant alone as
ratio_method_1 to ratio_method_5; null is a ratio that is not reported.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import statistics
from functools import partial
from pathlib import Path

import numpy as np
from rounds import Ratio, alternating, as_json, machine, processor_time, ratio_of

from ev_core.compiled.loop import FINISHED, Parts, run_instants
from ev_core.lockstep.parts import method_part
from ev_core.lockstep.run import GraphRun, call
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES
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
GOAL = 1.10  # of a run over its plant alone
PIECE = 100  # frames that stay in the processor's cache, as in a run
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


def steps_of(run: Run) -> int:
    """Control steps of a run."""
    return stamps.from_seconds(run.duration) // run.configurations[MASTER].period


def time_of_plant(run: Run) -> float:
    """Seconds in which the plant of a run takes as many steps as the run has, under constant commands.

    It records as a run does. The frames are made before: to turn recorded signals into frames takes
    as long as the steps, and differs from call to call.
    """
    plant = run.configurations[MASTER]
    size = max(frame.span(each.method.writes)[1] for each in run.configurations.values())
    frames = np.zeros((PIECE + 1, size))
    series = np.empty((size, steps_of(run) + 1))
    for command in COMMANDS:
        if type(command) in plant.method.reads:
            frames[:, PLACES[type(command)]] = shape_of(type(command)).flat(command)
    part = method_part(plant, compiled=True)
    row = np.array([(*part.addresses(), *frame.span(plant.method.writes))], np.int64)
    stopped = np.zeros(2, np.int64)
    call(part, 0, frames[0])

    def drive() -> None:
        for begin in range(0, steps_of(run), PIECE):
            count = min(PIECE, steps_of(run) - begin)
            status = run_instants(frames, 0, count, False, Parts(row, 0), stopped)
            assert status == FINISHED, status
            series[:, begin : begin + count + 1] = frames[: count + 1].T
            frames[0] = frames[count]

    return processor_time(drive)


def time_of_cycle(run: Run) -> float:
    """Seconds in which a run takes its steps; what comes before and after does not depend on their number."""
    graph = GraphRun(run.configurations, steps_of(run) + 1)
    return processor_time(lambda: graph.drive(lambda time: None, lambda role, text: None))


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=7, help="rounds")
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
    for run in cycles.values():
        graph_run(run.configurations, 0.0)
    ratios = {}
    print(f"{'run':<44}{'s':>8}{'us/step':>9}{'plant':>8}{'x real time':>13}  ratio")
    for name, run in cycles.items():
        measures = {"plant": partial(time_of_plant, run), "run": partial(time_of_cycle, run)}
        seconds = alternating(measures, arguments.repeats)
        ratios[name] = ratio_of(seconds["run"], seconds["plant"], GOAL)
        took, alone = map(statistics.median, (seconds["run"], seconds["plant"]))
        per_step = 1e6 / steps_of(run)
        print(
            f"{name:<44}{took:>8.3f}{took * per_step:>9.2f}{alone * per_step:>8.2f}"
            f"{run.duration / took:>13.0f}  {ratios[name]}",
            flush=True,
        )
    if arguments.json:
        arguments.json.write_text(json.dumps(document_of(ratios), indent=2) + "\n")


def document_of(ratios: dict[str, Ratio]) -> dict[str, object]:
    """What the file has."""
    five = {f"ratio_method_{n}": ratios[name].value for n, name in zip(FIVE, ratios, strict=False)}
    rows = [{"name": name, **as_json(ratio)} for name, ratio in ratios.items()]
    return {**machine(), **five, "rows": rows}


if __name__ == "__main__":
    main()
