"""Looks at the running graph: nodes, topics and rates, policies for DDS security, views for RViz and Foxglove."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from contextlib import suppress

from rclpy.node import Node
from rclpy.subscription import Subscription

from ev_msgs_py.refusal import LINE, shown
from ev_msgs_py.wire import message_class
from ev_stack.command_line.refusal import Parser
from ev_stack.commands.present_graph import full_names, in_the_graph, quality_of, topics_of, type_of
from ev_stack.commands.shell import Shell, messages, parser_of, shell_in, verb_of
from ev_stack.recording.outcome import RunFailed

_OWN_NAME = "inspect_graph"
_JOINS = 0.2  # s for publishers to find a subscription


def inspect(argv: list[str]) -> None:
    """scripts/inspect.sh [--seconds S] [--echo TOPIC]"""
    parser = Parser(prog="inspect.sh", description="Show the running graph: nodes, topics, rates.")
    parser.add_argument(
        "--seconds", type=_positive, default=2.0, help="how long rates are measured"
    )
    parser.add_argument(
        "--echo", metavar="TOPIC", help="print one message of this topic, as YAML, and end"
    )
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
    """Messages per second [Hz] by topic, in one time for all.

    Topics without an installed message type are left out.
    """
    subscriptions = {}
    for name, kind in topics.items():
        with suppress(ImportError):
            type_ = message_class(kind)
            # So deep that nothing is lost between two looks.
            quality = quality_of(node, name, depth=1000)
            subscriptions[name] = node.create_subscription(
                type_, name, lambda message: None, quality, raw=True
            )
    time.sleep(_JOINS)
    for subscription in subscriptions.values():
        _taken(subscription)  # what came while the others were being made
    counts = dict.fromkeys(subscriptions, 0)
    begun = time.monotonic()
    while (lasted := time.monotonic() - begun) < seconds:
        time.sleep(0.02)
        for name, subscription in subscriptions.items():
            counts[name] += _taken(subscription)
    # By the time that has passed, which is a little more than what was asked for.
    return {name: count / lasted for name, count in counts.items()}


def _taken(subscription: Subscription) -> int:
    """Count the messages since the last look."""
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
        lines.append(
            f"    {', '.join(writers[name]) or 'none'} -> {', '.join(readers[name]) or 'none'}"
        )
    return lines


def _names(ends: list) -> list[str]:
    # Our own subscriptions are in the graph, too, while rates are measured.
    return sorted({end.node_name for end in ends} - {_OWN_NAME})


def topic(argv: list[str]) -> None:
    """ev-stack topic list [-t] | echo TOPIC [--once] | hz TOPIC [--seconds S] | info TOPIC"""
    parser = parser_of("topic", "Show topics, their messages as YAML, their rates and their ends.")
    verbs = parser.add_subparsers(
        dest="what", required=True, metavar="list|echo|hz|info", parser_class=Parser
    )
    listed, echo, hz, info = (verb_of(verbs, name) for name in ("list", "echo", "hz", "info"))
    listed.add_argument("-t", "--show-types", action="store_true", help="with their types")
    for each in (echo, hz, info):
        each.add_argument("topic", help="such as wheel_states, or a full name such as /diagnostics")
    echo.add_argument("--once", action="store_true", help="one message and end")
    hz.add_argument("--seconds", type=_positive, default=2.0, help="how long it is measured")
    info.add_argument(
        "-v", "--verbose", action="store_true", help="with the nodes and their quality of service"
    )
    given = parser.parse_args(argv)
    with suppress(KeyboardInterrupt), shell_in(given.namespace) as shell:
        for text in {"list": _list, "echo": _echo, "hz": _hz, "info": _info}[given.what](
            shell, given
        ):
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
            # Ends of a topic with two types do not meet: then each is shown with its own.
            kind = f", {end.topic_type}" if len(there[name]) > 1 else ""
            yield f"  {end.node_namespace.rstrip('/')}/{end.node_name}: {words}{kind}"


def node(argv: list[str]) -> None:
    """ev-stack node list | info NODE"""
    parser = parser_of("node", "Show the nodes of the graph, their topics and their services.")
    verbs = parser.add_subparsers(
        dest="what", required=True, metavar="list|info", parser_class=Parser
    )
    verb_of(verbs, "list")
    verb_of(verbs, "info").add_argument("node", help="such as plant, or a full name")
    given = parser.parse_args(argv)
    with suppress(KeyboardInterrupt), shell_in(given.namespace) as shell:
        print(
            "\n".join(
                full_names(shell.node) if given.what == "list" else _about_node(shell, given.node)
            )
        )


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
