"""A stranger speaks on topics of a run, with the right stamps and other numbers: what does it change?

    source scripts/setup.sh && python benchmarks/strangers.py [--rates HZ ...] [--seconds S] [--each | --topics T ...]

The rate is that on each of the topics: all of them at once, with --each one after the other.
Printed are how many messages per second the stranger got rid of on each, the steps per second of
the run, whether its hash is that of the offline runner, and what was said of the stranger. With
--elsewhere the same process speaks in another domain, where nobody hears it: what remains then is
what its own work leaves of the machine.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rclpy
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of, stamp_of
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.stop_request import StopRequest
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.running.domain import free_domain
from ev_stack.running.processes import run_in_processes
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario

SCENARIO = "shchur2019"
OTHER = 7.0  # a finite number that the run does not give


def speak(rate: float, topics: list[str]) -> None:
    """Say that it is there, publish on topics until told to stop, and print the messages per second and topic."""
    rclpy.init()
    node = Node("stranger", namespace="/ev")
    clock = node.create_subscription(Clock, "/clock", lambda _: None, QUALITY, raw=True).handle
    formats = [format_of(signal) for signal, topic in TOPICS.items() if topic.name in topics]
    mouths = [
        node.create_publisher(f.message_class, f.topic.name, QUALITY).handle.publish_raw
        for f in formats
    ]
    other = Frame()
    other.numbers[:] = numbers_of([OTHER] * len(other.numbers))
    stamp, rounds, start = 0, 0, time.monotonic()
    print("here", flush=True)
    with StopRequest() as stop:
        while not stop.received:
            while (taken := clock.take_message(Clock, True)) is not None:
                stamp = stamp_of(taken[0])
            for format_, publish in zip(formats, mouths, strict=True):
                publish(format_.pack(stamp, other))
            rounds += 1
            time.sleep(max(start + rounds / rate - time.monotonic(), 0.0))
    print(rounds / (time.monotonic() - start))
    rclpy.shutdown()


def drive(
    run: Run, rate: float, topics: list[str], elsewhere: bool
) -> tuple[float, float, str, tuple[str, ...]]:
    """Messages per second of the stranger, steps per second, hash and remarks of a run with a process per node."""
    with (
        free_domain() as domain,
        free_domain() as other,
        tempfile.TemporaryDirectory() as directory,
    ):
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        try:
            words = [sys.executable, __file__, "--speak", str(rate), "--topics", *topics]
            where = os.environ | {"ROS_DOMAIN_ID": str(other if elsewhere else domain)}
            stranger = (
                subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=where)
                if rate
                else None
            )
            if stranger is not None:
                stranger.stdout.readline()  # coming up takes as much of the machine as the run
            outcome = run_in_processes(run, Path(directory), False, lambda time: None)
            said = 0.0
            if stranger is not None:
                stranger.terminate()
                said = float(stranger.communicate(timeout=20)[0])
        finally:
            del os.environ["ROS_DOMAIN_ID"]
    steps = (len(outcome.recording.time) - 1) / outcome.wall_time
    return said, steps, signal_hash(outcome.recording), (*outcome.not_reproducible, *outcome.notes)


def main() -> None:
    """Print a line per rate, or per rate and topic."""
    everything = [topic.name for topic in TOPICS.values()]
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--rates", type=float, nargs="+", default=[0.0, 100.0, 1000.0, 10000.0], metavar="HZ"
    )
    parser.add_argument("--seconds", type=float, default=50.0)
    parser.add_argument(
        "--topics", nargs="+", choices=everything, default=everything, metavar="TOPIC"
    )
    parser.add_argument("--each", action="store_true", help="a stranger on one topic at a time")
    parser.add_argument(
        "--elsewhere", action="store_true", help="the stranger speaks in another domain"
    )
    parser.add_argument("--speak", type=float, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.speak is not None:
        speak(given.speak, given.topics)
        return
    run = load_scenario(SCENARIO, Overrides(duration=given.seconds)).runs[0]
    expected = signal_hash(run_offline(run.configurations, run.duration))
    for rate in given.rates:
        for topics in [[name] for name in given.topics] if given.each and rate else [given.topics]:
            said, steps, found, remarks = drive(run, rate, topics, given.elsewhere)
            on = topics[0] if len(topics) == 1 else f"each of {len(topics)} topics"
            on += ", elsewhere" if given.elsewhere else ""
            print(f"{said:.0f} messages/s on {on}: {steps:.0f} steps/s, ", end="")
            print("hash of the offline run" if found == expected else f"OTHER HASH {found}")
            for remark in remarks:
                print(f"    {remark}", flush=True)


if __name__ == "__main__":
    main()
