"""Parameters and time of the nodes of a running graph, by the services that every node has.

How it works: nothing here waits. A request to a node is a future with what is to be done when it is
answered, what otherwise, and a deadline; `look`, which the server calls some times a second, takes
the answers that have come. A node that has appeared is asked for names, then descriptions, then
values of its parameters, each question in the answer of the one before.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future
from std_srvs.srv import Trigger

from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.refusal import quoted
from ev_nodes.master.schedule import TIME_SERVICES
from ev_nodes.stepping import ros_parameters
from ev_stack.commands.parameter_text import parameter_of

_LONGEST_LINE = 400  # characters
_PATIENCE = 3.0  # s of wall time for a node to answer
GRAPH_PERIOD = 1.0  # s between looks at which nodes there are
_AT_ONCE = 20  # answers that are taken in one look

Tell = Callable[[dict[str, Any]], None]


def line(text: str, refused: bool) -> dict[str, Any]:
    """The message that has a page show a text, as one line of bearable length."""
    text = " ".join(text.split())
    shown = text if len(text) <= _LONGEST_LINE else f"{text[:_LONGEST_LINE]}..."
    return {"kind": "word", "text": shown, "refused": refused}


class Controls:
    """Client of the nodes with roles; `tell` takes their parameters, answers and refusals."""

    def __init__(self, context: Context, namespace: str, name: str, tell: Tell) -> None:
        # A node of its own: the executor, which only services need, would take the messages of
        # another one.
        node = Node(
            name,
            context=context,
            namespace=namespace,
            start_parameter_services=False,
            enable_rosout=False,
        )
        # by name, the message with the parameters of the present nodes
        self.nodes: dict[str, dict[str, Any]] = {}
        self._node, self._tell = node, tell
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(node)
        self._of: dict[str, AsyncParameterClient] = {}
        # nodes with parameters that are known, or were asked for a moment ago
        self._asked: set[str] = set()
        self._present: set[str] = set()
        self._types: dict[tuple[str, str], Parameter.Type] = {}
        self._time = {
            name: node.create_client(Trigger, f"{MASTER}/{name}") for name in TIME_SERVICES
        }
        self._waiting: list[tuple[Future, Callable[[Any], None], Callable[[], None], float]] = []
        self._next_look = 0.0

    @property
    def has_master(self) -> bool:
        """Mark of a graph that has a master of time, as far as was looked."""
        return MASTER in self._present

    def look(self) -> None:
        """Take answers, give up those that do not come, and see which nodes there are."""
        for _ in range(_AT_ONCE if self._waiting else 0):
            self._executor.spin_once(timeout_sec=0.0)
        now = time.monotonic()
        # An answer may ask the next question, which goes into the new list.
        waiting, self._waiting = self._waiting, []
        for future, then, otherwise, deadline in waiting:
            if future.done():
                then(future.result())
            elif now < deadline:
                self._waiting.append((future, then, otherwise, deadline))
            else:
                otherwise()
        if now >= self._next_look:
            self._next_look = now + GRAPH_PERIOD
            self._find_nodes()

    def obey(self, request: Mapping[str, Any]) -> None:
        """Set a parameter, or call a service of time, for a page; ValueError for anything else."""
        try:
            if request["kind"] == "time":
                self._call(request["service"])
            elif request["kind"] == "set":
                self._set(request["node"], request["name"], request["value"])
            else:
                raise ValueError(
                    f"request {quoted(request['kind'])} is refused, expected set or time"
                )
        except (KeyError, TypeError) as error:
            raise ValueError(f"a request of a page is refused: {quoted(error)}") from None

    def say(self, text: str, refused: bool = True) -> None:
        """Have the pages show a line."""
        self._tell(line(text, refused))

    def close(self) -> None:
        """Stop asking."""
        self._executor.shutdown()
        self._node.destroy_node()

    def _find_nodes(self) -> None:
        here = self._node.get_namespace()
        there = self._node.get_node_names_and_namespaces()
        present = {name for name, space in there if space == here and name in ROLES}
        # A node that comes again is asked anew: it may have other parameters.
        for name in self._present - present:
            self._asked.discard(name)
            self.nodes.pop(name, None)
            self._tell({"kind": "gone", "node": name})
        self._present = present
        for name in sorted(present - self._asked):
            client = self._of.setdefault(name, AsyncParameterClient(self._node, name))
            # A service that is not there yet is looked for again a second later.
            if client.services_are_ready():
                self._asked.add(name)
                self._ask(
                    client.list_parameters(),
                    partial(self._listed, name),
                    partial(self._asked.discard, name),
                )

    def _listed(self, name: str, response: Any) -> None:
        names = [each for each in response.result.names if not ros_parameters.is_ros_own(each)]
        client, again = self._of[name], partial(self._asked.discard, name)

        def described(answer: Any) -> None:
            self._ask(
                client.get_parameters(names),
                partial(self._described, name, answer.descriptors),
                again,
            )

        self._ask(client.describe_parameters(names), described, again)

    def _described(self, name: str, descriptors: list[ParameterDescriptor], response: Any) -> None:
        values = [parameter_value_to_python(value) for value in response.values]
        for descriptor, value in zip(descriptors, response.values, strict=True):
            self._types[name, descriptor.name] = Parameter.Type(value.type)
        self.nodes[name] = node_message(name, descriptors, values)
        self._tell(self.nodes[name])

    def _set(self, node: str, name: str, value: Any) -> None:
        kind = self._types.get((node, name))
        if kind is None:
            raise ValueError(f"{node}.{name} is refused: no such parameter in this graph")
        try:
            parameter = parameter_of(name, kind, value)
        except ValueError as error:
            raise ValueError(f"{node}.{name}: {error}") from None
        self._ask(
            self._of[node].set_parameters_atomically([parameter]),
            lambda answer: self._was_set(node, name, _plain(parameter.value), answer.result),
            lambda: self.say(f"{node} does not answer; whether {name} was set is not known"),
        )

    def _was_set(self, node: str, name: str, value: Any, result: Any) -> None:
        for known in self.nodes.get(node, {}).get("parameters", ()):
            if known["name"] == name:
                # Also after a refusal, so that the page puts its field back.
                known["value"] = value if result.successful else known["value"]
                self._tell(
                    {"kind": "parameter", "node": node, "name": name, "value": known["value"]}
                )
        if result.successful:
            self.say(f"{node}.{name} = {value}", refused=False)
        else:
            self.say(f"{node} refuses: {result.reason}")

    def _call(self, service: str) -> None:
        if service not in self._time:
            raise ValueError(
                f"service {quoted(service)} is refused, expected {', '.join(self._time)}"
            )
        if not self._time[service].service_is_ready():
            raise ValueError(f"{service}: {MASTER} is not there")
        self._ask(
            self._time[service].call_async(Trigger.Request()),
            # success comes as a report
            lambda answer: None if answer.success else self.say(answer.message),
            lambda: self.say(f"{MASTER} does not answer; whether it did {service} is not known"),
        )

    def _ask(
        self, future: Future, then: Callable[[Any], None], otherwise: Callable[[], None]
    ) -> None:
        """Call `then` with the answer, or `otherwise` without one.

        A service that a graph has just found is lost at times.
        """
        self._waiting.append((future, then, otherwise, time.monotonic() + _PATIENCE))


def node_message(
    name: str, descriptors: Iterable[ParameterDescriptor], values: Iterable[Any]
) -> dict[str, Any]:
    """Build the message that shows a node on a page: its parameters, described, with values."""
    described = zip(descriptors, values, strict=True)
    parameters = [{**_about(descriptor), "value": _plain(value)} for descriptor, value in described]
    return {"kind": "node", "node": name, "parameters": parameters}


def _about(descriptor: ParameterDescriptor) -> dict[str, Any]:
    ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
    low, high = (ranges[0].from_value, ranges[0].to_value) if ranges else (None, None)
    return {
        "name": descriptor.name,
        "about": descriptor.description,
        "allowed": descriptor.additional_constraints,
        "fixed": descriptor.read_only,
        "whole": bool(descriptor.integer_range),
        "low": ros_parameters.limit_of(low),
        "high": ros_parameters.limit_of(high),
    }


def _plain(value: Any) -> Any:
    return (
        list(value)
        if value is not None and not isinstance(value, (str, bool, int, float))
        else value
    )
