"""The main function of every node executable, and its rules where DDS security is asked for."""

import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.exceptions import ParameterException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args
from rosidl_generator_py.import_type_support_impl import UnsupportedTypeSupport

from ev_core.methods.register import NODES
from ev_core.parameters.data_file import entry_points
from ev_msgs_py.contract.roles import MASTER, RECORDER, ROLES
from ev_msgs_py.refusal import LINE, quoted, shown
from ev_nodes.master.node import MasterNode
from ev_nodes.stepping import ros_parameters
from ev_nodes.stepping.ros_domain import given_domain
from ev_nodes.stepping.spinning import spin
from ev_nodes.stepping.stepped_node import SteppedNode
from ev_nodes.stepping.stop_request import KEPT, StopRequest, end, turn_deaf

# What rclpy raises where the middleware cannot do something, or a library of messages cannot be
# loaded.
OF_ROS = (RuntimeError, UnsupportedTypeSupport)
_QUIET: Any = {"enable_rosout": False, "start_parameter_services": False}
_USAGE = """usage: {name} [--ros-args [-r __ns:=/NAME] [-p PARAMETER:=VALUE ...] [--params-file FILE] ...]
Parameters: docs/parameters.md; of a running node: ev-stack param get {name}."""
# Argument of ROS for the nodes of a run and for commands: what they log is in the output folder or
# in the terminal, and ROS's own log file would need a home folder that can be written.
NO_LOG_FILE = "--disable-external-lib-logs"
SILENTLY = "EV_STACK_LEAVE_SILENTLY"  # variable of the environment: a runner sets it for its nodes


def security_is_asked_for(environment: Mapping[str, str]) -> bool:
    """Return whether ROS 2 shall encrypt and authenticate.

    ROS takes nothing but the word true for that.
    """
    return environment.get("ROS_SECURITY_ENABLE") == "true"


def refuse_weak_security(environment: Mapping[str, str]) -> None:
    """RuntimeError where security is asked for in a way in which ROS 2 would quietly do without it.

    With Enforce a node without keys, or with a middleware that was built without security, cannot
    be made: the line of that error names what it lacks.
    """
    enabled = environment.get("ROS_SECURITY_ENABLE", "false")
    if enabled not in ("true", "false"):
        raise RuntimeError(
            f"ROS_SECURITY_ENABLE: {quoted(enabled)} counts as no security, expected true or false"
        )
    strategy = environment.get("ROS_SECURITY_STRATEGY", "Permissive")
    if enabled == "true" and strategy != "Enforce":
        raise RuntimeError(
            f"ROS_SECURITY_STRATEGY: {quoted(strategy)} lets nodes without keys send unprotected,"
            " expected Enforce with ROS_SECURITY_ENABLE=true"
        )
    if enabled == "true" and not environment.get("ROS_SECURITY_KEYSTORE"):
        raise RuntimeError(
            "ROS_SECURITY_KEYSTORE: '' with ROS_SECURITY_ENABLE=true, expected the folder of the"
            " keys"
        )


def make_node(role: str, **node_arguments: Any) -> SteppedNode:
    """The node of a role; the plant is the master of time."""
    return MasterNode(**node_arguments) if role == MASTER else SteppedNode(role, **node_arguments)


def node_maker(role: str) -> Callable[..., Any]:
    """Function that makes the node of a role, given arguments of an rclpy node: `make` of its module, if it has one."""
    points = entry_points(group=NODES, name=role)
    modules = {import_module(point.module) for point in points}
    makers = [module.make for module in modules if hasattr(module, "make")]
    return makers[0] if len(makers) == len(modules) == 1 else partial(make_node, role)


def hidden_node(name: str, context: Context | None) -> Node:
    """A node that tools do not list, which keeps a process in the graph while the node of this name comes or goes."""
    return Node(f"_{name}", context=context, use_global_arguments=False, **_QUIET)


@contextmanager
def given_parameters(name: str, **node_arguments: Any) -> Iterator[dict[str, Any]]:
    """The parameters given to a node of this name, from which a role's `make` learns which node to make.

    The node must be made within the block. A context leaves the graph with its last node, and when
    a process leaves while others are finding each other, Fast DDS may lock one of these up for
    ever: removing what has left waits for its thread of timed events, which waits to announce
    itself. So another node stays meanwhile, under a hidden name, for the graph mixes up what
    belongs to two nodes of one name.
    """
    stays = hidden_node(name, node_arguments.get("context"))
    try:
        asked = Node(
            name, automatically_declare_parameters_from_overrides=True, **_QUIET, **node_arguments
        )
        try:
            given = ros_parameters.overrides(asked)
        finally:
            asked.destroy_node()
        yield given
    finally:
        stays.destroy_node()


def run_role(role: str) -> None:
    """Play a role until the run is over or the process is asked to stop.

    Exit status 1 and one line on bad input.
    """
    run_node(role, lambda: make_node(role))


def run_named_role() -> None:
    """Play the role that the program is named after, as in `ros2 run ev_sim plant`: a node that is just its role."""
    run_role(Path(sys.argv[0]).name)


def run_node(name: str, make: Callable[[], Any]) -> None:
    """Make a node, spin it, and turn refused input into one line and exit status 1.

    No signal counts behind that.
    """
    with StopRequest() as stop:
        node, trouble = None, ""
        try:
            others = remove_ros_args(sys.argv)[1:]
            if others and others[0] in ("-h", "--help"):
                print(_USAGE.format(name=name))
                end("")
            if others:  # ROS would silently ignore them: no --ros-args before them
                raise ValueError(
                    f"unknown argument {quoted(others[0])}; options of a node follow --ros-args"
                )
            refuse_weak_security(os.environ)
            rclpy.init(
                domain_id=given_domain(os.environ), signal_handler_options=SignalHandlerOptions.NO
            )
            node = make()
            own = node.get_name()
            if own != name and name in (*ROLES, RECORDER):  # no node would take its messages
                raise ValueError(
                    f"__node: {quoted(own)} is refused, expected {name}, as the others know it"
                )
            if SILENTLY not in os.environ:  # a runner knows by itself
                node.get_logger().info(f"ready, in ROS domain {node.context.get_domain_id()}")
            try:
                spin([node], lambda: node.done or stop.received)
            finally:
                node.close()
        except (ValueError, OSError, ParameterException, *OF_ROS) as error:
            trouble = f"{name}: {one_line(error)}"
        except KeyboardInterrupt:
            pass
        leave(node, trouble)


def leave(node: Any, trouble: str) -> NoReturn:
    """End the process, with status 1 and a line on stderr if there was trouble. No signal counts from here on.

    A node of a runner removes only its subscriptions from the graph, so that no node waits until it
    has received something: all nodes end together, and a process that reads a publisher which is
    just being removed holds a lock of Fast DDS and waits for its own thread of timed events. If
    that thread is about to announce its process, and waits for the lock, the process is locked up
    for ever (https://github.com/eProsima/Fast-DDS/issues/6502). Other nodes drop the rest when its
    lease is over, after 4 s. Any other node removes all that it has.

    The participant of the process is never deleted (`leave_graph`).
    """
    turn_deaf()
    if node is not None:
        if SILENTLY in os.environ:
            for subscription in list(node.subscriptions):
                node.destroy_subscription(subscription)
        elif node.context.ok():
            leave_graph(node)
    end(trouble)


def leave_graph(node: Node) -> None:
    """Remove a node from the graph, and keep the participant of the process, which has to end without Python's own end.

    Where others leave in the moment in which a participant is deleted, Fast DDS waits for its own
    callback in a loop which keeps that callback from ending
    (https://github.com/eProsima/Fast-DDS/issues/6513). The participant goes with the last node, so
    another one, under a hidden name, is there when the node goes.
    """
    KEPT[:] = [hidden_node(node.get_name(), node.context)]
    node.destroy_node()


def one_line(error: Exception) -> str:
    """The text of an error without line breaks and without the places in ROS's own source code."""
    if isinstance(error, rclpy_implementation.UnknownROSArgsError):
        return f"unknown ROS arguments {error}"
    cause = error.__context__ or error if isinstance(error, UnsupportedTypeSupport) else error
    return shown(" ".join(re.sub(r", at /\S+:\d+", "", str(cause)).split()), LINE)
