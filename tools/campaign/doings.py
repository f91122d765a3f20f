"""What a stranger does in the graph besides speaking: one entry for each act, by the name that a trial takes."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any, NamedTuple

import rclpy
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from campaign.sayings import ESCAPES, INVENTED
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of
from ev_nodes.master.schedule import TIME_SERVICES
from ev_nodes.stepping.signal_io import QUALITY

_ROLES = ("plant", "asr", "driver", "recorder")
_DOZEN, _SUBSCRIBERS = 12, 50
_PATIENCE, _MOMENT = 4.0, 0.3  # s
_WAITING = 200  # questions that are under way at once
_NAMES = ["real_time_factor", "method", "no.such", "", "x" * 10**4, ESCAPES + INVENTED]


class Doing(NamedTuple):
    """What is done by a node as long as `goes_on()`, at so many times a second."""

    about: str
    do: Callable[[Node, Callable[[], bool], float], None]


def _time_services(*calls: str) -> Callable[[Node, Callable[[], bool], float], None]:
    """Call services of the plant one after the other; the last one is called in any case."""

    def do(node: Node, goes_on: Callable[[], bool], _: float) -> None:
        clients = [node.create_client(Trigger, f"/ev/plant/{name}") for name in calls]
        for client in clients:
            if not client.wait_for_service(timeout_sec=_PATIENCE):
                return
            if goes_on() or client is clients[-1]:
                rclpy.spin_until_future_complete(
                    node, client.call_async(Trigger.Request()), timeout_sec=_PATIENCE
                )
                time.sleep(_MOMENT)

    return do


def _asks(
    service: type, name: str, request: Callable[[], Any]
) -> Callable[[Node, Callable[[], bool], float], None]:
    """A flood of questions to nodes of the run."""

    def do(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
        clients = [node.create_client(service, f"/ev/{role}/{name}") for role in _ROLES]
        asked: list[Any] = []
        for client in itertools.cycle(clients):
            if not goes_on():
                return
            asked = [future for future in asked if not future.done()][-_WAITING:]
            asked.append(client.call_async(request()))
            rclpy.spin_once(node, timeout_sec=1.0 / rate)

    return do


def _offers(
    kind: type, role: str, names: Iterable[str]
) -> Callable[[Node, Callable[[], bool], float], None]:
    """The services of a node of the run, which answer what comes to mind."""

    def do(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
        for name in names:
            node.create_service(kind, f"/ev/{role}/{name}", lambda _, response: response)
        while goes_on():
            rclpy.spin_once(node, timeout_sec=1.0 / rate)

    return do


def _publishers_come_and_go(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
    while goes_on():
        mouths = [
            node.create_publisher(format_of(s).message_class, t.name, QUALITY)
            for s, t in TOPICS.items()
        ]
        time.sleep(1.0 / rate)
        for mouth in mouths:
            node.destroy_publisher(mouth)


def _nodes_come_and_go(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
    while goes_on():
        nodes = [
            Node(name, namespace="/ev") for name in (*_ROLES, *(f"n{n}" for n in range(_DOZEN)))
        ]
        time.sleep(1.0 / rate)
        for each in nodes:
            each.destroy_node()


def _contexts_come_and_go(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
    """Each context is a participant of its own, which nodes meet and lose."""
    while goes_on():
        context = rclpy.Context()
        rclpy.init(context=context)
        for name in _ROLES:
            with suppress(RuntimeError):
                Node(name, namespace="/ev", context=context)
        time.sleep(1.0 / rate)
        context.try_shutdown()


def _never_takes(node: Node, goes_on: Callable[[], bool], rate: float) -> None:
    topics = itertools.cycle(TOPICS.items())
    for signal, topic in itertools.islice(topics, _SUBSCRIBERS):
        node.create_subscription(
            format_of(signal).message_class, topic.name, lambda _: None, QUALITY
        )
    while goes_on():
        time.sleep(1.0 / rate)


def _by_names(service: Any) -> Callable[[], Any]:
    return lambda: service.Request(names=_NAMES)


def _unknown() -> SetParameters.Request:
    parameters = [
        Parameter(name, value=value)
        for name in _NAMES[2:]
        for value in (float("nan"), True, INVENTED, [1])
    ]
    return SetParameters.Request(
        parameters=[parameter.to_parameter_msg() for parameter in parameters]
    )


DOINGS = {
    "pause": Doing("stops time for a moment", _time_services("pause", "resume")),
    "three steps": Doing("lets the run go step by step", _time_services("pause", "step", "step", "step", "resume")),
    "steps alone": Doing("grants steps without a pause", _time_services("step", "step", "step", "resume")),
    "gets parameters": Doing("asks for values", _asks(GetParameters, "get_parameters", _by_names(GetParameters))),
    "describes parameters": Doing(
        "asks for descriptions", _asks(DescribeParameters, "describe_parameters", _by_names(DescribeParameters))
    ),
    "lists parameters": Doing("asks for all names", _asks(ListParameters, "list_parameters", ListParameters.Request)),
    "sets what is not there": Doing("parameters of nobody", _asks(SetParameters, "set_parameters", _unknown)),
    "offers to stop time": Doing("has the plant's services", _offers(Trigger, "plant", TIME_SERVICES)),
    "offers parameters": Doing("has a service of asr", _offers(SetParameters, "asr", ["set_parameters"])),
    "publishers come and go": Doing("makes and destroys publishers of all topics", _publishers_come_and_go),
    "nodes come and go": Doing("makes and destroys nodes, some with names of the run's", _nodes_come_and_go),
    "processes come and go": Doing("joins the graph and leaves it", _contexts_come_and_go),
    "never takes": Doing("fifty subscriptions that take nothing", _never_takes),
}  # fmt: skip
