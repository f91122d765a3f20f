"""Looks at the running graph: nodes, topics and rates, policies for DDS security, views for RViz and Foxglove."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from contextlib import suppress

import rclpy
from rclpy.exceptions import InvalidNamespaceException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from rclpy.validate_namespace import validate_namespace

from ev_core.nodes.stop_request import StopRequest
from ev_core.run_role import NO_LOG_FILE, leave_graph
from ev_msgs_py.refusal import LINE, shown
from ev_msgs_py.wire import message_class
from ev_sim.command_line.refusal import Parser, refuse
from ev_sim.commands.present_graph import full_names, in_the_graph, quality_of, topics_of, type_of
from ev_sim.commands.shell import Shell, messages, parser_of, shell_in, verb_of
from ev_sim.recording.outcome import RunFailed

_OWN_NAME = "inspect_graph"
_JOINS = 0.2  # s for publishers to find a subscription


def inspect(argv: list[str]) -> None:
    """scripts/inspect.sh [--seconds S] [--echo TOPIC]"""
    parser = Parser(prog="inspect.sh", description="Show the running graph: nodes, topics, rates.")
    parser.add_argument("--seconds", type=_positive, default=2.0, help="how long rates are measured")
    parser.add_argument("--echo", metavar="TOPIC", help="print one message of this topic, as YAML, and end")
    given = parser.parse_args(argv)
    try:
        with suppress(KeyboardInterrupt), in_the_graph(_OWN_NAME) as node:
            if given.echo:
                print(next(messages(node, given.echo)), end="")
            else:
                print("\n".join(shown(line, LINE) for line in _graph(node, given.seconds)))
    except (LookupError, RunFailed) as error:
        sys.exit(error.args[0])


def _positive(text: str) -> float:
    seconds = float(text)
    if not 0.0 < seconds < float("inf"):
        raise ValueError
    return seconds


def _rates(node: Node, topics: dict[str, str], seconds: float) -> dict[str, float]:
    """Messages per second [Hz] by topic, in one time for all; without topics whose message type is not installed."""
    subscriptions = {}
    for name, kind in topics.items():
        with suppress(ImportError):
            type_ = message_class(kind)
            quality = quality_of(node, name, depth=1000)
            subscriptions[name] = node.create_subscription(type_, name, lambda message: None, quality, raw=True)
    time.sleep(_JOINS)
    for subscription in subscriptions.values():
        _taken(subscription)  # what came while the others were being made
    counts = dict.fromkeys(subscriptions, 0)
    begun = time.monotonic()
    while (lasted := time.monotonic() - begun) < seconds:
        time.sleep(0.02)
        for name, subscription in subscriptions.items():
            counts[name] += _taken(subscription)
    return {name: count / lasted for name, count in counts.items()}


def _taken(subscription: Subscription) -> int:
    """How many messages have come since the last look."""
    count = 0
    while subscription.handle.take_message(subscription.msg_type, True) is not None:
        count += 1
    return count


def _graph(node: Node, seconds: float) -> list[str]:
    topics = topics_of(node)
    writers = {name: _names(node.get_publishers_info_by_topic(name)) for name in topics}
    readers = {name: _names(node.get_subscriptions_info_by_topic(name)) for name in topics}
    rates = _rates(node, {name: kinds[0] for name, kinds in topics.items()}, seconds)
    lines = ["nodes", *(f"  {name}" for name in full_names(node)), "", "topics"]
    for name, kinds in topics.items():
        rate = f"{rates[name]:.1f} Hz" if name in rates else "message type is not installed"
        lines.append(f"  {name}  {', '.join(kinds)}  {rate}")
        lines.append(f"    {', '.join(writers[name]) or 'nobody'} -> {', '.join(readers[name]) or 'nobody'}")
    return lines


def _names(ends: list) -> list[str]:
    return sorted({end.node_name for end in ends} - {_OWN_NAME})


def topic(argv: list[str]) -> None:
    """ev-stack topic list [-t] | echo TOPIC [--once] | hz TOPIC [--seconds S] | info TOPIC"""
    parser = parser_of("topic", "Show topics, their messages as YAML, their rates and their ends.")
    verbs = parser.add_subparsers(dest="what", required=True, metavar="list|echo|hz|info", parser_class=Parser)
    listed, echo, hz, info = (verb_of(verbs, name) for name in ("list", "echo", "hz", "info"))
    listed.add_argument("-t", "--show-types", action="store_true", help="with their types")
    for each in (echo, hz, info):
        each.add_argument("topic", help="such as wheel_states, or a full name such as /diagnostics")
    echo.add_argument("--once", action="store_true", help="one message and end")
    hz.add_argument("--seconds", type=_positive, default=2.0, help="how long it is measured")
    info.add_argument("-v", "--verbose", action="store_true", help="with the nodes and their quality of service")
    given = parser.parse_args(argv)
    with suppress(KeyboardInterrupt), shell_in(given.namespace) as shell:
        for text in {"list": _list, "echo": _echo, "hz": _hz, "info": _info}[given.what](shell, given):
            print(text, flush=True)


def _list(shell: Shell, given: argparse.Namespace) -> Iterator[str]:
    for name, kinds in topics_of(shell.node).items():
        yield f"{name} [{', '.join(kinds)}]" if given.show_types else name


def _echo(shell: Shell, given: argparse.Namespace) -> Iterator[str]:
    for text in messages(shell.node, shell.full_name(given.topic)):
        yield text.removesuffix("\n")
        if given.once:
            return
        yield "---"


def _hz(shell: Shell, given: argparse.Namespace) -> Iterator[str]:
    name = shell.full_name(given.topic)
    for rate in _rates(shell.node, {name: type_of(shell.node, name)}, given.seconds).values():
        yield f"average rate: {rate:.1f} Hz"


def _info(shell: Shell, given: argparse.Namespace) -> Iterator[str]:
    node, name = shell.node, shell.full_name(given.topic)
    if name not in (there := topics_of(node)):
        type_of(node, name)  # names what there is
    yield f"Type: {', '.join(there[name])}"
    for side, ends in (
        ("Publisher", node.get_publishers_info_by_topic(name)),
        ("Subscription", node.get_subscriptions_info_by_topic(name)),
    ):
        yield f"{side} count: {len(ends)}"
        for end in ends if given.verbose else ():
            quality = end.qos_profile
            words = f"{quality.reliability.name}, {quality.durability.name}".lower()
            kind = f", {end.topic_type}" if len(there[name]) > 1 else ""
            yield f"  {end.node_namespace.rstrip('/')}/{end.node_name}: {words}{kind}"


def node(argv: list[str]) -> None:
    """ev-stack node list | info NODE"""
    parser = parser_of("node", "Show the nodes of the graph, their topics and their services.")
    verbs = parser.add_subparsers(dest="what", required=True, metavar="list|info", parser_class=Parser)
    verb_of(verbs, "list")
    verb_of(verbs, "info").add_argument("node", help="such as plant, or a full name")
    given = parser.parse_args(argv)
    with suppress(KeyboardInterrupt), shell_in(given.namespace) as shell:
        print("\n".join(full_names(shell.node) if given.what == "list" else _about_node(shell, given.node)))


def _about_node(shell: Shell, node: str) -> Iterator[str]:
    full_name = shell.present(node)
    space, _, name = full_name.rpartition("/")
    yield full_name
    for what, of_node in (
        ("Subscribers", shell.node.get_subscriber_names_and_types_by_node),
        ("Publishers", shell.node.get_publisher_names_and_types_by_node),
        ("Service Servers", shell.node.get_service_names_and_types_by_node),
    ):
        yield f"  {what}:"
        for end, kinds in sorted(of_node(name, space or "/")):
            yield f"    {end}: {', '.join(kinds)}"


_ABOUT_POLICIES = "Write the policy file of the graph for DDS security, or hold the running graph against it."


def policies(argv: list[str]) -> None:
    """ev-stack security_policies [--namespace /ev] [--check]"""
    from ev_sim.security.permissions import permissions, permissions_in_use, policy_file, violations

    parser = Parser(prog="security_policies", description=_ABOUT_POLICIES)
    parser.add_argument("--namespace", type=_namespace, default="/ev", help="of the nodes; default /ev")
    parser.add_argument(
        "--check", action="store_true", help="hold the running graph against it, status 1 if it does more"
    )
    given = parser.parse_args(argv)
    allowed = permissions(given.namespace)
    if not given.check:
        print(policy_file(given.namespace, allowed.values()), end="")
        return
    try:
        with in_the_graph("security_policies") as node:
            used = permissions_in_use(node, given.namespace)
    except (LookupError, RunFailed) as error:
        refuse(error.args[0])
    if not used:
        refuse(f"no node is running in namespace {given.namespace}")
    found = violations(allowed, used.values())
    print(f"{len(used)} nodes, {len(found)} things that the policy does not allow", *found, sep="\n")
    sys.exit(bool(found))


def _namespace(text: str) -> str:
    namespace = text.rstrip("/")
    try:
        validate_namespace(namespace or "/")
    except InvalidNamespaceException as error:
        raise argparse.ArgumentTypeError(str(error).splitlines()[0]) from None
    return namespace


_VISUALIZATION = "visualization"  # in the graph
_VIEW_PERIOD = 0.05  # s of wall time between two looks


def visualize(argv: list[str]) -> None:
    """ev-stack visualization [--ros-args ...]; the namespace is /ev unless -r __ns:=/NAME gives another one."""
    from ev_sim.dashboard.controls import Controls
    from ev_sim.dashboard.live_frames import LiveFrames
    from ev_sim.dashboard.ros_views import RosViews
    from ev_sim.views.messages import CarViews

    with StopRequest() as stop:
        rclpy.init(args=[*argv, "--ros-args", NO_LOG_FILE], signal_handler_options=SignalHandlerOptions.NO)
        try:
            node = rclpy.create_node(_VISUALIZATION, namespace="ev", start_parameter_services=False)
            frames = LiveFrames(node, lambda cause, text: node.get_logger().warning(text, once=True))
            views = RosViews(node, node.get_logger().warning)
            controls = Controls(node.context, node.get_namespace(), f"{_VISUALIZATION}_controls", frames.take_car)
            was_there = False
            while not stop.received and (controls.has_master or not was_there):
                was_there |= controls.has_master
                controls.look()
                if frames.look() and frames.vehicle is not None:
                    rear_is_steered = "rear_steering" in controls.nodes
                    views.publish(frames.recording, CarViews(node.get_namespace(), frames.vehicle, rear_is_steered))
                time.sleep(_VIEW_PERIOD)
            leave_graph(node)
        finally:
            rclpy.try_shutdown()
    print(f"{_VISUALIZATION}: stopped" if stop.received else f"{_VISUALIZATION}: the run has ended")
