"""Lockstep steps per second of the full graph beside a bare relay ring, measured in turn in one run.

    source scripts/setup.sh && python benchmarks/lockstep.py [--steps N] [--repeats N] [--json FILE]

The rings have as many processes as the graph has nodes. Each relay waits for one message and sends one of the next type
of the graph's chain; nothing is computed. There are two: `ring` is a node as rclpy offers it, typed messages on its
fastest executor, and `raw_ring` the least that is possible over this middleware, serialized messages and one wait set.
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
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    SteeringColumnState,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.nodes.run_role import make_node
from ev_msgs_py.nodes.signal_io import QUALITY
from ev_msgs_py.nodes.spinning import spin
from ev_msgs_py.wire.message_format import format_of
from ev_sim.run.domain import free_domain
from ev_sim.run.in_process import parameter_overrides
from ev_sim.run.node_parameters import RECORDER, node_parameters, write_parameter_file
from ev_sim.run.offline import run_offline
from ev_sim.run.processes import command
from ev_sim.run.scenarios.scenario import Overrides, load_scenario

SCENARIO = "shchur2019"
CHAIN = (BodyVelocity, DriverCommand, WheelTorqueRequest, WheelTorqueCommand, SteeringColumnState)
WARM_UP = 100  # rounds before the clock starts
STEPS_PER_SECOND = re.compile(r"([\d.]+) steps/s")


class Relay(Node):
    """Sends the message of one type on when one of the type before has come."""

    def __init__(self, place: int, raw: bool, context: rclpy.Context | None = None) -> None:
        super().__init__(f"relay{place}", context=context)
        incoming, outgoing = format_of(CHAIN[place - 1]), format_of(CHAIN[place])
        self.incoming = incoming.message_class
        self.message = outgoing.template if raw else deserialize_message(outgoing.template, outgoing.message_class)
        self.sender = self.create_publisher(outgoing.message_class, f"ring{place}", QUALITY)
        before = f"ring{(place - 1) % len(CHAIN)}"
        self.came = False
        self.receiver = self.create_subscription(self.incoming, before, self._receive, QUALITY, raw=raw)

    def _receive(self, message: object) -> None:
        self.came = True

    def connected(self) -> bool:
        """Whether both neighbours are there."""
        return self.sender.get_subscription_count() > 0 and self.receiver.get_publisher_count() > 0

    def take(self) -> bool:
        """Whether a message has come."""
        return self.receiver.handle.take_message(self.incoming, True) is not None

    def send(self) -> None:
        """Send the next message of the ring."""
        self.sender.publish(self.message)


def receive_raw(relay: Relay) -> None:
    """Wait for a message, by a wait set of its own."""
    while not relay.take():
        _sleep(relay)


def receive_typed(relay: Relay, executor: EventsExecutor) -> None:
    """Wait for a message, by the executor."""
    while not relay.came:
        executor.spin_once(timeout_sec=1.0)
    relay.came = False


def _sleep(relay: Relay) -> None:
    with relay.context.handle:
        wait_set = rclpy_implementation.WaitSet(1, 0, 0, 0, 0, 0, relay.context.handle)
        wait_set.add_subscription(relay.receiver.handle)
        wait_set.wait(1_000_000_000)


def relay_process(place: int, raw: bool, rounds: int) -> None:
    """One process of a ring; the first one counts the rounds and prints their rate."""
    rclpy.init()
    relay = Relay(place, raw)
    executor = EventsExecutor()
    executor.add_node(relay)
    receive = partial(receive_raw, relay) if raw else partial(receive_typed, relay, executor)
    while not relay.connected():
        time.sleep(0.01)
    if place == 0:
        time.sleep(0.5)  # the others may still be connecting
        relay.send()
    for count in range(WARM_UP + rounds):
        receive()
        if place == 0 and count == WARM_UP:
            start = time.monotonic()
        relay.send()
    if place == 0:
        print(f"{(rounds - 1) / (time.monotonic() - start):.1f} steps/s", flush=True)
    time.sleep(0.5)  # the last message is still on its way


def measured_rate(commands: list[list[str]], domain: int, directory: Path) -> float:
    """Start processes, the one that prints its rate first, and read that rate."""
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    logs = [(directory / f"{i}.log").open("w+") for i in range(len(commands))]
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


def ring_of_processes(steps: int, *options: str) -> float:
    """Rounds per second of the ring with a process per relay."""
    relay = [sys.executable, __file__, "--steps", str(steps), *options, "--relay"]
    commands = [[*relay, str(place)] for place in range(len(CHAIN))]
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        return measured_rate(commands, domain, Path(directory))


def raw_ring_of_processes(steps: int) -> float:
    """The same of the ring of serialized messages."""
    return ring_of_processes(steps, "--raw")


def loaded_run(steps: int):
    """The scenario, as long as the steps last."""
    return load_scenario(SCENARIO, Overrides(duration=steps * 0.01)).runs[0]


def graph_of_processes(steps: int) -> float:
    """Steps per second of the graph with a process per node, without recorder."""
    run = loaded_run(steps)
    with free_domain() as domain, tempfile.TemporaryDirectory() as directory:
        nodes = graph_parameters(run, Path(directory))
        file = Path(directory) / "parameters.yaml"
        write_parameter_file(file, run, nodes)
        arguments = ["--ros-args", "--params-file", str(file), "-r", f"__ns:={run.namespace}"]
        return measured_rate([[*command(name), *arguments] for name in nodes], domain, Path(directory))


def graph_parameters(run, directory: Path) -> dict[str, dict]:
    """Parameters of the nodes of the graph, the plant first, without recorder."""
    nodes = node_parameters(run, directory, bag=False)
    del nodes[RECORDER]
    nodes["plant"]["await_recorder"] = False
    return nodes


def raw_ring_in_one_process(rounds: int) -> float:
    """Rounds per second of the ring of serialized messages with all relays in this process, polled in their order."""
    with free_domain() as domain:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        relays = [Relay(place, True, context) for place in range(len(CHAIN))]
        while not all(relay.connected() for relay in relays):
            time.sleep(0.01)
        relays[0].send()
        for count in range(WARM_UP + rounds):
            if count == WARM_UP:
                start = time.monotonic()
            for relay in (*relays[1:], relays[0]):
                while not relay.take():
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
        nodes = [
            make_node(name, context=context, namespace=run.namespace, parameter_overrides=parameter_overrides(values))
            for name, values in graph_parameters(run, Path(directory)).items()
        ]
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


def main() -> None:
    """Print the table, and write it as JSON where asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--relay", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--raw", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.relay is not None:
        relay_process(given.relay, given.raw, given.steps)
        return
    offline(given.steps)  # compiles what is not compiled yet
    measures = (
        ring_of_processes,
        raw_ring_of_processes,
        graph_of_processes,
        raw_ring_in_one_process,
        graph_in_one_process,
        offline,
    )
    rates: dict[str, list[float]] = {measure.__name__: [] for measure in measures}
    for _ in range(given.repeats):
        for measure in measures:
            rates[measure.__name__].append(measure(given.steps))
    median = {name: statistics.median(values) for name, values in rates.items()}
    ratio = {
        "graph_of_processes / ring_of_processes": _ratio(rates, "graph_of_processes", "ring_of_processes"),
        "graph_of_processes / raw_ring_of_processes": _ratio(rates, "graph_of_processes", "raw_ring_of_processes"),
        "graph_in_one_process / raw_ring_in_one_process": _ratio(
            rates, "graph_in_one_process", "raw_ring_in_one_process"
        ),
    }
    for name, values in rates.items():
        print(f"{name:24} {median[name]:9.0f} steps/s   ({min(values):.0f} to {max(values):.0f})")
    for name, value in ratio.items():
        print(f"{name:48} {value:.2f}")
    if given.json:
        content = {"steps": given.steps, "steps_per_second": rates, "median": median, "ratio": ratio}
        given.json.write_text(json.dumps(content, indent=2) + "\n")


def _ratio(rates: dict[str, list[float]], of: str, to: str) -> float:
    """Median of the ratios within each repeat: what disturbs the machine disturbs both."""
    return statistics.median(a / b for a, b in zip(rates[of], rates[to], strict=True))


if __name__ == "__main__":
    main()
