"""Commands on the running graph without the ros2 command: time, parameters, messages."""

from __future__ import annotations

import math
import sys
import time
from argparse import SUPPRESS
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property, partial
from typing import Any

import yaml
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.serialization import deserialize_message
from rclpy.task import Future
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import LINE, quoted
from ev_msgs_py.wire import message_class
from ev_nodes.stepping import ros_parameters
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.commands.parameter_text import parameter_of
from ev_stack.commands.present_graph import (
    awaited,
    full_names,
    in_the_graph,
    master_namespace,
    quality_of,
    type_of,
)
from ev_stack.recording.outcome import RunFailed

_NAME = "ev_stack_shell"
_PATIENCE = 5.0  # s for a node to answer
_ABOUT_TIME = {
    "pause": "Let simulated time stand still.",
    "resume": "Let simulated time go on.",
    "step": "Let one step pass, or several, and stand still then.",
    "reset": "Restart at time zero, with the parameters as they are.",
}
_SILENCE = 2.0  # s of wall time without a message that are reported


class Shell:
    """Asks the nodes of a graph.

    Raises LookupError, in one line, for what is not there or does not answer.
    """

    def __init__(self, node: Node, namespace: str | None) -> None:
        self.node, self._wanted = node, namespace
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    @cached_property
    def namespace(self) -> str:
        """That of the graph; names that are absolute need none."""
        return master_namespace(self.node, self._wanted)

    def close(self) -> None:
        """Stop asking."""
        self._executor.shutdown()

    def answer(self, name: str, future: Future) -> Any:
        """Wait for the answer of a node."""
        self._executor.spin_until_future_complete(future, _PATIENCE)
        if not future.done():
            raise LookupError(f"{name} does not answer")
        return future.result()

    def call(self, service: str) -> str:
        """Call a service of the master of time; what it says."""
        name = f"{self.full_name(MASTER)}/{service}"
        client = self.node.create_client(Trigger, name)
        if not client.wait_for_service(_PATIENCE):
            raise LookupError(f"{name} is not there")
        text: str = self.answer(MASTER, client.call_async(Trigger.Request())).message
        return text

    def full_name(self, name: str) -> str:
        """Full name of a node or topic; a relative one is in the namespace of the graph."""
        return name if name.startswith("/") else f"{self.namespace.rstrip('/')}/{name}"

    def has_parameters(self, node: str) -> bool:
        """Return True if a node, by its full name, has parameters: a runner has none."""
        namespace, _, name = node.rpartition("/")
        if namespace != self.namespace.rstrip("/"):
            return False
        services = dict(self.node.get_service_names_and_types_by_node(name, namespace or "/"))
        return f"{node}/get_parameters" in services

    def present(self, name: str) -> str:
        """The full name of a node; LookupError if it is not in the graph."""
        name = self.full_name(name)

        def look() -> str:
            if name not in (there := full_names(self.node)):
                raise LookupError(f"no node {quoted(name)}; there are {', '.join(there)}")
            return name

        return awaited(self.node, look)

    def parameters_of(
        self, name: str, also: str | None = None
    ) -> tuple[AsyncParameterClient, dict[str, Parameter]]:
        """Client of a node, and its parameters by name; of ROS's own only that one."""
        name = self.present(name)
        client = AsyncParameterClient(self.node, name)
        if not client.wait_for_services(_PATIENCE):
            raise LookupError(f"{name} has no parameters that can be asked for")
        listed = self.answer(name, client.list_parameters()).result.names
        # What ROS declares in every node, such as use_sim_time, is not listed, but may be asked
        # for.
        names = sorted(
            each for each in listed if each == also or not ros_parameters.is_ros_own(each)
        )
        values = self.answer(name, client.get_parameters(names)).values if names else []
        return client, {
            each: Parameter(
                each, Parameter.Type(value.type), _plain(parameter_value_to_python(value))
            )
            for each, value in zip(names, values, strict=True)
        }


def _plain(value: Any) -> Any:
    return (
        list(value)
        if value is not None and not isinstance(value, (str, bool, int, float))
        else value
    )


@contextmanager
def shell_in(namespace: str | None) -> Iterator[Shell]:
    """Asks the present graph; what cannot be done ends the process with one line."""
    try:
        with in_the_graph(_NAME) as node:
            shell = Shell(node, namespace)
            try:
                yield shell
            finally:
                shell.close()
    except (LookupError, RunFailed, ValueError) as error:
        refuse(error.args[0])


def parser_of(name: str, about: str) -> Parser:
    """Words of a command for a running graph."""
    parser = Parser(
        prog=f"ev-stack {name}",
        description=(
            f"{about} Of the run under way, of several ROS_DOMAIN_ID=N says which; nodes started by"
            " hand are in domain 0 unless that is set."
        ),
    )
    parser.add_argument(
        "--namespace", metavar="/NAME", help="of the graph, where a domain has several"
    )
    return parser


def verb_of(verbs: Any, name: str) -> Parser:
    """A verb, behind which options may stand as in the ros2 command."""
    parser: Parser = verbs.add_parser(name)
    about = "of the graph, where a domain has several"
    parser.add_argument("--namespace", metavar="/NAME", default=SUPPRESS, help=about)
    return parser


def _control_time(service: str, argv: Sequence[str]) -> None:
    parser = parser_of(service, _ABOUT_TIME[service])
    if service == "step":
        parser.add_argument(
            "count", nargs="?", type=_positive, default=1, help="of steps, default 1"
        )
    given = parser.parse_args(argv)
    with shell_in(given.namespace) as shell:
        for _ in range(getattr(given, "count", 1)):
            answer = shell.call(service)
        print(answer)


def _positive(text: str) -> int:
    count = int(text)
    if count < 1:
        raise ValueError
    return count


pause, resume, step, reset = (partial(_control_time, service) for service in _ABOUT_TIME)


def param(argv: Sequence[str]) -> None:
    """ev-stack param list [NODE] | get NODE [NAME] | describe NODE NAME | set NODE NAME VALUE | dump [NODE]"""
    parser = parser_of("param", "Show and set parameters of nodes, as YAML.")
    what = parser.add_subparsers(
        dest="what", required=True, metavar="|".join(_VERBS), parser_class=Parser
    )
    listed, get, describe, put, dump = (verb_of(what, name) for name in _VERBS)
    for each in (get, describe, put):
        each.add_argument("node", help="such as plant, or a full name")
    get.add_argument("name", nargs="?", help="of the parameter; default: all")
    describe.add_argument("name")
    put.add_argument("name")
    put.add_argument("value", help="as in YAML")
    for each in (listed, dump):
        each.add_argument(
            "node", nargs="*", help="default: all nodes of the graph that have parameters"
        )
    given = parser.parse_args(argv)
    with shell_in(given.namespace) as shell:
        print(_VERBS[given.what](shell, given), end="")


def _get(shell: Shell, given: Any) -> str:
    _, there = shell.parameters_of(given.node, given.name)
    if given.name is None:
        return as_yaml({name: each.value for name, each in there.items()})
    # YAML ends a bare value by a line of dots.
    return as_yaml(_known(given, there).value).removesuffix("...\n")


def _known(given: Any, there: dict[str, Parameter]) -> Parameter:
    if given.name not in there:
        raise LookupError(
            f"{given.node} has no parameter {quoted(given.name)}; ev-stack param get {given.node}"
            " lists all"
        )
    return there[given.name]


def _describe(shell: Shell, given: Any) -> str:
    client, there = shell.parameters_of(given.node, given.name)
    value = _known(given, there).value
    (found,) = shell.answer(given.node, client.describe_parameters([given.name])).descriptors
    words = {
        "about": found.description,
        "expected": found.additional_constraints.removeprefix("allowed: "),
    }
    return as_yaml({"value": value, **words, "read_only": found.read_only})


def _set(shell: Shell, given: Any) -> str:
    client, there = shell.parameters_of(given.node, given.name)
    before = _known(given, there)
    try:
        # A parameter of ROS keeps its type, so the text is read as one of that.
        parameter = parameter_of(given.name, before.type_, given.value)
    except ValueError as error:
        raise ValueError(f"{given.node}.{given.name}: {error}") from None
    result = shell.answer(given.node, client.set_parameters_atomically([parameter])).result
    if not result.successful:
        raise ValueError(f"{given.node} refuses: {result.reason}")
    return f"{given.node}.{given.name}: {before.value} -> {_plain(parameter.value)}\n"


def _all(shell: Shell, given: Any) -> dict[str, dict[str, Parameter]]:
    nodes = given.node or [each for each in full_names(shell.node) if shell.has_parameters(each)]
    return {shell.full_name(node): shell.parameters_of(node)[1] for node in nodes}


def _list(shell: Shell, given: Any) -> str:
    found = _all(shell, given).items()
    return "".join(f"{node}:\n" + "".join(f"  {name}\n" for name in there) for node, there in found)


def _dump(shell: Shell, given: Any) -> str:
    values = {
        node: {name: each.value for name, each in there.items()}
        for node, there in _all(shell, given).items()
    }
    return as_yaml({node: {"ros__parameters": each} for node, each in values.items()})


_VERBS = {"list": _list, "get": _get, "describe": _describe, "set": _set, "dump": _dump}


def messages(node: Node, name: str) -> Iterator[str]:
    """The messages of a topic as they come, as YAML.

    Raises LookupError if there is no such topic, or no package for it.

    Where none comes, one line on standard error tells whether simulated time goes on.
    """
    type_ = type_of(node, name)
    try:
        kind = message_class(type_)
    except ImportError:
        raise LookupError(
            f"{name} cannot be read: {type_.partition('/')[0]} is not installed"
        ) from None
    quality = quality_of(node, name, depth=10)
    take = node.create_subscription(
        kind, name, lambda message: None, quality, raw=True
    ).handle.take_message
    take_clock = node.create_subscription(
        Clock, "/clock", lambda message: None, 10, raw=True
    ).handle.take_message
    report_at, times = time.monotonic() + _SILENCE, set[bytes]()
    while True:
        if (taken := take(kind, True)) is not None:
            yield as_yaml(plain_message(deserialize_message(taken[0], kind)))
            # A message has come: the silence is over, and what the clock did in it does not count.
            report_at, times = time.monotonic() + _SILENCE, set()
            continue
        time.sleep(0.01)
        while (taken := take_clock(Clock, True)) is not None:
            times.add(taken[0])
        if time.monotonic() > report_at:
            # Once for each silence.
            report_at = math.inf
            goes_on = (
                "goes on"
                if len(times) > 1
                else "stands still, in a paused run until ev-stack resume or step"
            )
            print(
                f"{name}: no message within {_SILENCE:g} s; simulated time {goes_on}",
                file=sys.stderr,
            )


def plain_message(message: Any) -> Any:
    """A message as dictionaries, lists and numbers, its fields in their order."""
    if hasattr(message, "get_fields_and_field_types"):
        return {
            name: plain_message(getattr(message, name))
            for name in message.get_fields_and_field_types()
        }
    if isinstance(message, bytes):
        return list(message)
    if isinstance(message, (str, bool, int, float)):
        return message
    return (
        message.tolist()
        if hasattr(message, "tolist")
        else [plain_message(each) for each in message]
    )


def as_yaml(content: Any) -> str:
    """Write YAML, with lists of numbers on one line."""
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=LINE)
