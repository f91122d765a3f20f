"""Memory, file descriptors and rate of the nodes over a million steps and more: all must stay flat.

    source scripts/setup.sh && python benchmarks/soak.py [--steps N] [--one-process-steps N] [--json FILE]

The graph is that of shchur2019, with its recorder where every node is a process. Every stamp that
is seen must be a whole multiple of the period. The first tenth is warm-up. Exit status 1 if the
memory of a process did not stay flat, which some thousand steps are too few to tell.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import rclpy
from lockstep import graph_commands, graph_nodes
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from ev_msgs_py.contract import stamps
from ev_nodes.stepping.spinning import spin
from ev_stack.running.children import same_addresses
from ev_stack.running.domain import free_domain
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario

PERIOD = 0.1  # s; ten million steps pass a million seconds
LOOKS = 20
PATIENCE = 60.0  # s without a step
ENOUGH = 10_000  # steps
# kB that a process may grow by behind the warm-up: less than 5 bytes in each of a million steps
FLAT = 4096


@dataclass(frozen=True)
class Look:
    """What the processes hold at an instant."""

    step: int
    wall_time: float  # s
    cpu_time: float  # s, of all processes together
    memory: dict[str, int]  # resident [kB]
    descriptors: dict[str, int]


def look(step: int, processes: dict[str, int]) -> Look:
    """At processes, by what the system tells of them."""
    memory, descriptors, ticks = {}, {}, 0
    for name, process in processes.items():
        status = Path(f"/proc/{process}/status").read_text()
        memory[name] = int(status.partition("VmRSS:")[2].split()[0])
        descriptors[name] = len(os.listdir(f"/proc/{process}/fd"))
        of_user, of_system = (
            Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]
        )
        ticks += int(of_user) + int(of_system)
    return Look(step, time.monotonic(), ticks / os.sysconf("SC_CLK_TCK"), memory, descriptors)


def endless_run(steps: int) -> Run:
    """The scenario, as long as the steps last."""
    values = [("*", "control_period", PERIOD)]
    return load_scenario(
        "shchur2019", Overrides(values=values, duration=(steps + 1) * PERIOD)
    ).runs[0]


def follow(domain: int, steps: int, processes: dict[str, int]) -> list[Look]:
    """Looks at processes until the graph has made so many steps."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    observer = Node("soak", context=context, start_parameter_services=False)
    clock = observer.create_subscription(Clock, "/clock", lambda message: None, QoSProfile(depth=1))
    looks: list[Look] = []
    progress = time.monotonic()
    while not looks or looks[-1].step < steps:
        time.sleep(0.001)
        taken = clock.handle.take_message(Clock, False)
        if taken is None:
            if time.monotonic() > progress + PATIENCE:
                sys.exit(f"no step for {PATIENCE:g} s after step {looks[-1].step if looks else 0}")
            continue
        progress = time.monotonic()
        stamp = stamps.read(taken[0].clock)
        step, rest = divmod(stamp, stamps.from_seconds(PERIOD))
        if rest:
            sys.exit(f"stamp {stamp} ns is no multiple of the period")
        if step >= steps * len(looks) // LOOKS:
            looks.append(look(step, processes))
            print(f"step {step}: {sum(looks[-1].memory.values())} kB", file=sys.stderr, flush=True)
    context.shutdown()
    return looks


def of_processes(steps: int) -> list[Look]:
    """The graph with a process per node."""
    run = endless_run(steps)
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        commands = graph_commands(run, Path(directory), recorder=True)
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        with same_addresses():
            started = {
                name: subprocess.Popen(words, env=environment) for name, words in commands.items()
            }
        try:
            return follow(domain, steps, {name: process.pid for name, process in started.items()})
        finally:
            for process in started.values():
                process.kill()
                process.wait()


def in_one_process(steps: int) -> list[Look]:
    """The graph with all nodes in one process, other than the one that looks."""
    with free_domain() as domain:
        process = multiprocessing.get_context("spawn").Process(
            target=_drive, args=(steps, domain), daemon=True
        )
        process.start()
        try:
            return follow(domain, steps, {"all nodes": process.pid})
        finally:
            process.kill()
            process.join()


def _drive(steps: int, domain: int) -> None:
    run = endless_run(steps)
    with tempfile.TemporaryDirectory() as directory:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        nodes = graph_nodes(run, Path(directory), context)
        spin(nodes, lambda: nodes[0].done)


def summary(looks: list[Look]) -> dict[str, float]:
    """Rates of the first and last quarter after the warm-up, and what has grown from its end to the last step.

    The rate is one of this machine and of what else it does; CPU time per step depends on that much
    less.
    """
    steady = looks[len(looks) // 10 :]
    quarter = len(steady) // 4
    first, last = (steady[0], steady[quarter]), (steady[-1 - quarter], steady[-1])
    return {
        "steps": steady[-1].step,
        "first_rate": _rate(*first),
        "last_rate": _rate(*last),
        "first_cpu_time_of_a_step_us": _cpu_time(*first),
        "last_cpu_time_of_a_step_us": _cpu_time(*last),
        "largest_growth_of_memory_kB": max(growth(looks).values()),
        "largest_growth_of_descriptors": max(
            steady[-1].descriptors[name] - steady[0].descriptors[name]
            for name in steady[0].descriptors
        ),
    }


def growth(looks: list[Look]) -> dict[str, int]:
    """By how many kB the memory of each process has grown behind the warm-up."""
    begin, end = looks[len(looks) // 10].memory, looks[-1].memory
    return {name: end[name] - begin[name] for name in begin}


def memory_table(looks: list[Look]) -> str:
    """A row for each process: what it held at some steps, what it has grown by, and whether that is flat [kB]."""
    shown = [looks[0], *looks[len(looks) // 10 : -1 : 3], looks[-1]]
    grown = growth(looks)
    rows = [["VmRSS [kB] at step", *(str(each.step) for each in shown), "grown by", ""]]
    for name in grown:
        flat = (
            "too few steps"
            if looks[-1].step < ENOUGH
            else "flat"
            if grown[name] <= FLAT
            else "NOT FLAT"
        )
        rows.append([name, *(str(each.memory[name]) for each in shown), str(grown[name]), flat])
    return "\n".join(
        f"{row[0]:24}" + "".join(f"{text:>10}" for text in row[1:-1]) + f"  {row[-1]}"
        for row in rows
    )


def _rate(begin: Look, end: Look) -> float:
    # of a few steps: there is none
    return (end.step - begin.step) / (end.wall_time - begin.wall_time or math.nan)


def _cpu_time(begin: Look, end: Look) -> float:
    return 1e6 * (end.cpu_time - begin.cpu_time) / (end.step - begin.step or math.nan)


def main() -> None:
    """Print what was found, and write every look as JSON where asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--steps", type=int, default=1_000_000, help="over DDS, with a process per node"
    )
    parser.add_argument(
        "--one-process-steps", type=int, default=10_000_000, help="with all nodes in one process"
    )
    parser.add_argument("--json", type=Path, metavar="FILE")
    given = parser.parse_args()
    found = {}
    for name, way, steps in (
        ("processes", of_processes, given.steps),
        ("one process", in_one_process, given.one_process_steps),
    ):
        if steps:
            found[name] = way(steps)
            print(
                name,
                *(f"  {key}: {value:.6g}" for key, value in summary(found[name]).items()),
                sep="\n",
            )
            print(memory_table(found[name]), flush=True)
    if given.json:
        given.json.write_text(
            json.dumps({name: [asdict(each) for each in looks] for name, looks in found.items()})
        )
    told = [looks for looks in found.values() if looks[-1].step >= ENOUGH]
    sys.exit(any(grown > FLAT for looks in told for grown in growth(looks).values()))


if __name__ == "__main__":
    main()
