"""All nodes of a run in this process over DDS, in their own domain, and a probe outside."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from helpers.patience import PATIENCE
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from std_srvs.srv import Trigger

from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.contract.stamps import from_seconds, to_seconds
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.wire import format_of, message_class
from ev_nodes.run_role import make_node
from ev_nodes.stepping.reports import HEALTH
from ev_nodes.stepping.runner_line import TIME_SERVICE
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.spinning import spin
from ev_stack.recorder_node import RecorderNode
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import PARAMETERS, load, signal_hash
from ev_stack.running.domain import free_domain
from ev_stack.running.offline import RECORDER, node_parameters, write_parameter_file
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

NAMESPACE = "/ev"
NODES = (*REQUIRED, RECORDER)
SERVICES = ("pause", "resume", "step", "reset")
_LOOK_PERIOD = 0.005


def shchur(duration: float, **values: Any) -> Run:
    """The run of shchur2019; `plant__drive="averaged"` sets a parameter."""
    words = [(*name.split("__", 1), value) for name, value in values.items()]
    return load_scenario("shchur2019", Overrides(values=words, duration=duration)).runs[0]


def offline_hash(run: Run) -> str:
    """The hash of a run without DDS."""
    return signal_hash(run_offline(run.configurations, run.duration))


def recorded_hash(directory: Path) -> str:
    """The hash of what the recorder has written."""
    return signal_hash(load(directory / "signals.npz"))


@contextmanager
def ros_domain() -> Iterator[Context]:
    """A context in a domain of its own."""
    with free_domain() as domain:
        context = Context()
        rclpy.init(context=context, domain_id=domain)
        try:
            yield context
        finally:
            context.try_shutdown()


def node_of(context: Context, name: str, values: dict[str, Any], namespace: str = NAMESPACE) -> Any:
    """A node by its name, with these parameters."""
    arguments: dict[str, Any] = {
        "context": context,
        "namespace": namespace,
        "parameter_overrides": [Parameter(key, value=value) for key, value in values.items()],
    }
    return RecorderNode(**arguments) if name == RECORDER else make_node(name, **arguments)


def publisher(node: Node, topic: Topic) -> Any:
    """A node's publisher on a topic of the contract."""
    return node.create_publisher(message_class(topic.message_type), topic.name, QUALITY)


class Probe(Node):
    """Looks at a graph and speaks to it."""

    def __init__(self, context: Context) -> None:
        super().__init__("probe", context=context, namespace=NAMESPACE)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self)
        self._publishers_of: dict[type, Any] = {}
        self._mouths: dict[str, Node] = {}  # by role; only the node with its name may speak for it
        self.callers = {name: self.create_client(Trigger, f"plant/{name}") for name in SERVICES}
        self.heard: dict[type, list[tuple[int, Any]]] = {}
        self.reports: list[str] = []
        self.health: dict[str, dict[str, str]] = {}
        self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 100)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name.endswith(TIME_SERVICE):
                continue
            if status.name.endswith(HEALTH):
                self.health[status.name] = {value.key: value.value for value in status.values}
            else:
                self.reports.append(f"{status.name}: {status.message}")

    def listen(self, signal: type) -> list[tuple[int, Any]]:
        """The list to which stamps and signals of a topic are added from now on."""
        heard = self.heard.setdefault(signal, [])
        topic = TOPICS[signal]
        kind = message_class(topic.message_type)

        def hear(message: bytes) -> None:
            stamp, numbers = format_of(signal).read(message)
            heard.append((stamp, shape_of(signal).signal_of(numbers)))

        self.create_subscription(kind, topic.name, hear, QUALITY, raw=True)
        return heard

    def packed(self, seconds: float, signal: Any) -> bytes:
        """A message as nodes publish it."""
        here = Frame()
        here.numbers[PLACES[type(signal)]] = numbers_of(shape_of(type(signal)).flat(signal))
        return format_of(type(signal)).pack(from_seconds(seconds), here)

    def message(self, seconds: float, signal: Any) -> Any:
        """A message object, for tests that spoil it."""
        return deserialize_message(
            self.packed(seconds, signal), message_class(TOPICS[type(signal)].message_type)
        )

    def publisher_of(self, signal: type) -> Any:
        """A publisher of a signal, of a node with the name of the role that writes it."""
        if signal not in self._publishers_of:
            topic, role = TOPICS[signal], WRITERS[signal]
            if role not in self._mouths:
                self._mouths[role] = Node(
                    role, context=self.context, namespace=NAMESPACE, start_parameter_services=False
                )
            self._publishers_of[signal] = publisher(self._mouths[role], topic)
        return self._publishers_of[signal]

    def look(self) -> None:
        """Take what has come."""
        for _ in range(20):
            self._executor.spin_once(timeout_sec=0.0)


class Graph:
    """Nodes of one context, run by one of the three ways there are."""

    def __init__(
        self,
        context: Context,
        run: Run,
        directory: Path,
        names: Sequence[str] | None = None,
        bag: bool = False,
    ) -> None:
        self.context = context
        self.directory = directory
        self.parameters = node_parameters(run, directory, bag)
        if bag:
            write_parameter_file(directory / PARAMETERS, run, self.parameters)
        self.nodes: dict[str, Any] = {}
        self.probe = Probe(context)
        for name in self.parameters if names is None else names:
            self.start(name)

    def start(self, name: str) -> Any:
        """Bring a node up."""
        self.nodes[name] = node_of(self.context, name, self.parameters[name])
        return self.nodes[name]

    def kill(self, name: str) -> None:
        """Take a node out as if its process had ended."""
        self.nodes.pop(name).destroy_node()
        gc.collect()  # a node is in the graph for as long as anything holds it

    @property
    def time(self) -> float:
        """Time of the master [s]."""
        return to_seconds(self.nodes["plant"].now)

    def _reached(self) -> float | None:
        """Time of the master [s]; None while there is none."""
        return self.time if "plant" in self.nodes else None

    def run(self, until: Callable[[], bool] | None = None, way: Callable[..., None] = spin) -> None:
        """Run until something holds, by default until the recorder has all.

        Fail where time stands still too long.
        """
        until = until or (lambda: self.nodes[RECORDER].done)
        next_look = 0.0
        reached, since = self._reached(), time.monotonic()

        def finished() -> bool:
            nonlocal next_look, reached, since
            if self._reached() != reached:
                reached, since = self._reached(), time.monotonic()
            if time.monotonic() >= next_look:
                self.probe.look()
                next_look = time.monotonic() + _LOOK_PERIOD
            assert time.monotonic() < since + PATIENCE, f"at {reached} s; {self.probe.reports}"
            return until()

        way(list(self.nodes.values()), finished)

    def run_rounds(self, rounds: int = 20) -> None:
        """Look at every node so many times.

        Between two looks at which nothing has come they sleep.
        """
        left = iter(range(rounds))
        self.run(lambda: next(left, None) is None)

    def can_be_called(self) -> bool:
        """Return True if the services of the plant are known."""
        return all(client.service_is_ready() for client in self.probe.callers.values())

    def call(self, service: str) -> str:
        """Call a service of the plant while the run is under way, and return its answer."""
        answer = self.probe.callers[service].call_async(Trigger.Request())
        self.run(answer.done)
        assert answer.result().success
        assert RECORDER not in self.nodes or not self.nodes[RECORDER].done, (
            "the run ended before the call"
        )
        return answer.result().message


@contextmanager
def graph(
    run: Run, directory: Path, names: Sequence[str] | None = None, bag: bool = False
) -> Iterator[Graph]:
    """A graph in a domain of its own."""
    with ros_domain() as context:
        yield Graph(context, run, directory, names, bag)


def by_rclpy(executor_type: type) -> Callable[[Sequence[Node], Callable[[], bool]], None]:
    """Run nodes by one of rclpy's executors, as an embedding program would."""

    def run(nodes: Sequence[Node], finished: Callable[[], bool]) -> None:
        executor = executor_type(context=nodes[0].context)
        for node in nodes:
            executor.add_node(node)
        while not finished():
            executor.spin_once(timeout_sec=0.01)
        for node in nodes:
            executor.remove_node(node)
        executor.shutdown()

    return run


WAYS = {
    "spin": spin,
    "SingleThreadedExecutor": by_rclpy(SingleThreadedExecutor),
    "EventsExecutor": by_rclpy(EventsExecutor),
}
