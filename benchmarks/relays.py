"""Bare relays over DDS, which compute nothing: the measure of what the middleware takes (benchmarks/lockstep.py).

    python benchmarks/relays.py RELAY ROUNDS [--raw] [--pattern]

One process of a ring, or with --pattern of relays that hear and send what the nodes of the graph
do; with --raw by serialized messages and one wait set, else by typed messages and rclpy's fastest
executor.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription

from ev_core.lockstep.stepper import arrival_place
from ev_msgs_py.contract.roles import INTEGRATED, ROLES, RoleKind
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    SteeringColumnState,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.wire import format_of
from ev_nodes.stepping.signal_io import QUALITY
from ev_stack.scenarios.scenario import load_scenario

SCENARIO = "shchur2019"
CHAIN = (BodyVelocity, DriverCommand, WheelTorqueRequest, WheelTorqueCommand, SteeringColumnState)
WARM_UP = 100  # rounds before the clock starts
# what each relay hears, the last to come last, and sends
Links = dict[str, tuple[tuple[type, ...], tuple[type, ...]]]


def ring_links() -> Links:
    """Each type of the chain leads to the next."""
    return {f"relay{i}": ((CHAIN[i - 1],), (CHAIN[i],)) for i in range(len(CHAIN))}


def pattern_links() -> Links:
    """What the nodes of the scenario hear, and of what they could send that which is heard; the master first."""
    methods = {
        role: configuration.method
        for role, configuration in load_scenario(SCENARIO).runs[0].configurations.items()
    }
    heard = {signal for method in methods.values() for signal in method.inputs}
    return {
        role: (
            tuple(sorted(method.inputs, key=arrival_place)),
            tuple(s for s in method.writes if s in heard),
        )
        for role, method in methods.items()
    }


class Relay(Node):
    """Sends one message of each of some types when one of each of others has come."""

    def __init__(
        self, name: str, links: Links, raw: bool, context: rclpy.Context | None = None
    ) -> None:
        super().__init__(name, context=context)
        reads, writes = links[name]
        self.coming = 0
        self.receivers = [
            self.create_subscription(
                format_of(kind).message_class, kind.__name__, self._receive, QUALITY, raw=raw
            )
            for kind in reads
        ]
        self.senders = [self._sender(kind, raw) for kind in writes]
        self._audience = sum(kind in others for kind in writes for others, _ in links.values())

    def _sender(self, kind: type, raw: bool) -> tuple[Publisher, object]:
        how = format_of(kind)
        message = how.template if raw else deserialize_message(how.template, how.message_class)
        return self.create_publisher(how.message_class, kind.__name__, QUALITY), message

    def _receive(self, message: object) -> None:
        self.coming -= 1

    def connected(self) -> bool:
        """Whether all neighbours are there."""
        audience = sum(publisher.get_subscription_count() for publisher, _ in self.senders)
        return audience == self._audience and all(
            receiver.get_publisher_count() for receiver in self.receivers
        )

    def take(self, receiver: Subscription) -> bool:
        """Whether a message has come."""
        return receiver.handle.take_message(receiver.msg_type, True) is not None

    def send(self) -> None:
        """Send the next messages."""
        for publisher, message in self.senders:
            publisher.publish(message)


def receive_raw(relay: Relay) -> None:
    """Wait for a message of each kind, by a wait set of its own; the last to come is waited for first."""
    for receiver in reversed(relay.receivers):
        while not relay.take(receiver):
            _sleep(relay, receiver)


def receive_typed(relay: Relay, executor: EventsExecutor) -> None:
    """Wait for a message of each kind, by the executor."""
    relay.coming += len(relay.receivers)
    while relay.coming > 0:
        executor.spin_once(timeout_sec=1.0)


def _sleep(relay: Relay, receiver: Subscription) -> None:
    with relay.context.handle:
        wait_set = rclpy_implementation.WaitSet(1, 0, 0, 0, 0, 0, relay.context.handle)
        wait_set.add_subscription(receiver.handle)
        wait_set.wait(1_000_000_000)


def relay_process(name: str, pattern: bool, raw: bool, rounds: int) -> None:
    """One process of relays; the first one counts the rounds and prints their rate."""
    links = pattern_links() if pattern else ring_links()
    rclpy.init()
    relay = Relay(name, links, raw)
    executor = EventsExecutor()
    executor.add_node(relay)
    receive = partial(receive_raw, relay) if raw else partial(receive_typed, relay, executor)
    while not relay.connected():
        time.sleep(0.01)
    time.sleep(0.5)  # the others may still be connecting
    first = name == next(iter(links))
    if first or (pattern and ROLES[name].kind is RoleKind.INTEGRATES):
        relay.send()
    if first and pattern:  # the others that integrate are one message ahead
        for receiver, kind in zip(relay.receivers, links[name][0], strict=True):
            while kind in INTEGRATED and not relay.take(receiver):
                _sleep(relay, receiver)
    for count in range(WARM_UP + rounds):
        receive()
        if first and count == WARM_UP:
            start = time.monotonic()
        relay.send()
    if first:
        print(f"{(rounds - 1) / (time.monotonic() - start):.1f} steps/s", flush=True)
    time.sleep(0.5)  # the last message is still on its way


def main() -> None:
    """Run one relay."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("relay")
    parser.add_argument("rounds", type=int)
    parser.add_argument("--raw", action="store_true")
    parser.add_argument("--pattern", action="store_true")
    given = parser.parse_args()
    relay_process(given.relay, given.pattern, given.raw, given.rounds)


if __name__ == "__main__":
    main()
