"""A node in the graph that observes a run, with keys of its own where DDS security is asked for."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from ev_core.nodes.time_of_day import Alarm, refuse_late_time_of_day
from ev_core.run_role import one_line, refuse_weak_security, security_is_asked_for
from ev_sim.recording.outcome import RunFailed


@contextmanager
def observing(namespace: str, domain: int, name: str) -> Iterator[Node]:
    """A node in the graph of a domain; RunFailed where ROS 2 refuses it, as without keys, or fails."""
    refuse_unready()
    context = rclpy.Context()
    try:
        try:
            rclpy.init(args=enclave(name, namespace), context=context, domain_id=domain)
            observer = Node(name, context=context, namespace=namespace, start_parameter_services=False)
        except RuntimeError as error:
            raise RunFailed(one_line(error)) from None
        with Alarm(observer):
            yield observer
        observer.destroy_node()
    except rclpy_implementation.RCLError as error:
        raise RunFailed(one_line(error)) from None
    finally:
        context.try_shutdown()


def refuse_unready() -> None:
    """RunFailed where ROS 2 would leave security away in silence, or could send nothing at this time of day."""
    try:
        refuse_weak_security(os.environ)
        refuse_late_time_of_day()
    except RuntimeError as error:
        raise RunFailed(one_line(error)) from None


def enclave(node: str, namespace: str) -> list[str]:
    """The ROS arguments that name the keys of a process, where security is asked for."""
    return ["--ros-args", "--enclave", f"{namespace}/{node}"] if security_is_asked_for(os.environ) else []
