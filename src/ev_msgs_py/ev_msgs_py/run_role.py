"""The main function of every node executable."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions

from ev_msgs_py.master_node import MasterNode
from ev_msgs_py.roles import MASTER
from ev_msgs_py.spinning import spin
from ev_msgs_py.stepped_node import SteppedNode


def make_node(role: str, **node_arguments: Any) -> SteppedNode:
    """The node of a role; the plant is the master of time."""
    return MasterNode(**node_arguments) if role == MASTER else SteppedNode(role, **node_arguments)


def run_role(role: str) -> None:
    """Play a role until the run is over or the process is told to stop; exit status 1 and one line on bad input."""
    run_node(role, lambda: make_node(role))


def run_node(name: str, make: Callable[[], SteppedNode]) -> None:
    """Make a node, spin it, and turn refused input into one line and exit status 1."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.ALL)
    node = None
    try:
        node = make()
        spin([node], lambda: node.done)
    except (ValueError, RuntimeError) as error:
        sys.exit(f"{name}: {error}")
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
