"""Lockstep steps per second of the full graph beside bare relays, measured in alternating rounds.

    source scripts/setup.sh && python benchmarks/lockstep.py [--steps N] [--repeats N] [--json FILE]

The rings have as many processes as the graph has nodes, and nothing is computed. In a ring each
relay waits for one message and sends one of the next type of the graph's chain. `ring` is a node as
rclpy offers it, typed messages on its fastest executor, and `raw_ring` the least that rclpy offers,
serialized messages and one wait set. The relays of `raw_pattern` hear and send what the nodes of
the graph do, message for message; they run in Python, whereas nodes take their ordinary steps in
compiled code. All start as the nodes of a run do.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import rclpy
import relays
from relays import SCENARIO, WARM_UP, Links, Relay, pattern_links, ring_links
from rounds import alternating, as_json, ratio_of

from ev_nodes.run_role import make_node
from ev_nodes.stepping.spinning import spin
from ev_stack.recording.offline import run_offline
from ev_stack.running.children import same_addresses
from ev_stack.running.domain import free_domain
from ev_stack.running.node_process import command
from ev_stack.running.offline import RECORDER, node_parameters, write_parameter_file
from ev_stack.running.processes import parameter_overrides
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.scenario import load_scenario

STEPS_PER_SECOND = re.compile(r"([\d.]+) steps/s")


def measured_rate(commands: list[list[str]], domain: int, directory: Path) -> float:
    """Start processes, the one that prints its rate first, and read that rate."""
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    logs = [(directory / f"{i}.log").open("w+") for i in range(len(commands))]
    with same_addresses():
        processes = [
            subprocess.Popen(words, env=environment, stdout=log, stderr=subprocess.STDOUT)
            for words, log in zip(commands, logs, strict=True)
        ]
    try:
        processes[0].wait(timeout=300)
    finally:
        for process in processes:
            process.kill()
            process.wait()
    logs[0].seek(0)
    return float(STEPS_PER_SECOND.findall(logs[0].read())[-1])


def ring_of_processes(steps: int) -> float:
    """Rounds per second of the ring with a process per relay."""
    return relays_in_processes(ring_links(), steps)


def raw_ring_of_processes(steps: int) -> float:
    """The same of the ring of serialized messages."""
    return relays_in_processes(ring_links(), steps, "--raw")


def raw_pattern_of_processes(steps: int) -> float:
    """The same of relays that send each other what the nodes of the graph do."""
    return relays_in_processes(pattern_links(), steps, "--raw", "--pattern")


def relays_in_processes(links: Links, steps: int, *options: str) -> float:
    """Rounds per second of relays with a process each."""
    relay = [sys.executable, relays.__file__]
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        return measured_rate(
            [[*relay, name, str(steps), *options] for name in links], domain, Path(directory)
        )


def loaded_run(steps: int):
    """The scenario, as long as the steps last."""
    return load_scenario(SCENARIO, Overrides(duration=steps * 0.01)).runs[0]


def graph_of_processes(steps: int) -> float:
    """Steps per second of the graph with a process per node, without recorder."""
    run = loaded_run(steps)
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        commands = graph_commands(run, Path(directory))
        return measured_rate(list(commands.values()), domain, Path(directory))


def graph_commands(run, directory: Path, recorder: bool = False) -> dict[str, list[str]]:
    """How the nodes of the graph are started, the plant first."""
    nodes = graph_parameters(run, directory, recorder)
    file = directory / "parameters.yaml"
    write_parameter_file(file, run, nodes)
    arguments = ["--ros-args", "--params-file", str(file), "-r", f"__ns:={run.namespace}"]
    return {name: [*command(name), *arguments] for name in nodes}


def graph_nodes(run, directory: Path, context) -> list:
    """The nodes of the graph in this process, the plant first, without recorder."""
    return [
        make_node(
            name,
            context=context,
            namespace=run.namespace,
            parameter_overrides=parameter_overrides(values),
        )
        for name, values in graph_parameters(run, directory).items()
    ]


def graph_parameters(run, directory: Path, recorder: bool = False) -> dict[str, dict]:
    """Parameters of the nodes of the graph, the plant first."""
    nodes = node_parameters(run, directory, bag=recorder)
    if not recorder:
        del nodes[RECORDER]
        nodes["plant"]["await_recorder"] = False
    return nodes


def raw_ring_in_one_process(rounds: int) -> float:
    """Rounds per second of the ring of serialized messages with all relays in this process, polled in their order."""
    with free_domain() as domain:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        relays = [Relay(name, ring_links(), True, context) for name in ring_links()]
        while not all(relay.connected() for relay in relays):
            time.sleep(0.01)
        relays[0].send()
        for count in range(WARM_UP + rounds):
            if count == WARM_UP:
                start = time.monotonic()
            for relay in (*relays[1:], relays[0]):
                while not relay.take(relay.receivers[0]):
                    pass
                relay.send()
        rate = rounds / (time.monotonic() - start)
        context.shutdown()
    return rate


def graph_in_one_process(steps: int) -> float:
    """Steps per second of the graph with all nodes in this process."""
    run = loaded_run(steps)
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        nodes = graph_nodes(run, Path(directory), context)
        spin(nodes, lambda: nodes[0].now > 0)
        start, begun = time.monotonic(), nodes[0].now
        spin(nodes, lambda: nodes[0].done)
        rate = (nodes[0].now - begun) / run.period / (time.monotonic() - start)
        context.shutdown()
    return rate


def offline(steps: int) -> float:
    """Steps per second without DDS."""
    run = loaded_run(steps)
    start = time.monotonic()
    run_offline(run.configurations, run.duration)
    return steps / (time.monotonic() - start)


MEASURES = {
    measure.__name__: measure
    for measure in (
        ring_of_processes,
        raw_ring_of_processes,
        raw_pattern_of_processes,
        graph_of_processes,
        raw_ring_in_one_process,
        graph_in_one_process,
        offline,
    )
}
RATIOS = (
    ("graph_of_processes", "ring_of_processes"),
    ("graph_of_processes", "raw_ring_of_processes"),
    ("graph_of_processes", "raw_pattern_of_processes"),
    ("graph_in_one_process", "raw_ring_in_one_process"),
)


def main() -> None:
    """Print the table, and write it as JSON where asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=5, help="rounds")
    parser.add_argument(
        "--only", choices=MEASURES, nargs="+", metavar="MEASURE", help="by default all"
    )
    parser.add_argument("--json", type=Path, metavar="FILE")
    given = parser.parse_args()
    measures = {
        name: partial(measure, given.steps)
        for name, measure in MEASURES.items()
        if not given.only or name in given.only
    }
    rates = alternating(measures, given.repeats)
    median = {name: statistics.median(values) for name, values in rates.items()}
    ratios = {
        f"{of} / {to}": ratio_of(rates[of], rates[to])
        for of, to in RATIOS
        if of in rates and to in rates
    }
    for name, values in rates.items():
        print(f"{name:24} {median[name]:9.0f} steps/s   ({min(values):.0f} to {max(values):.0f})")
    for name, ratio in ratios.items():
        print(f"{name:48} {ratio}")
    if given.json:
        content = {
            "steps": given.steps,
            "steps_per_second": rates,
            "median": median,
            "ratio": {name: as_json(ratio) for name, ratio in ratios.items()},
        }
        given.json.write_text(json.dumps(content, indent=2) + "\n")


if __name__ == "__main__":
    main()
