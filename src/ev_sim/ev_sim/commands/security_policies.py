"""Write the policy file of the graph for DDS security, or hold the running graph against it."""

from __future__ import annotations

import argparse
import sys
import time

import rclpy
from rclpy.exceptions import InvalidNamespaceException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.validate_namespace import validate_namespace

from ev_sim.command_line.refusal import Parser, refuse
from ev_sim.security.permissions import permissions, permissions_in_use, policy_file, violations

_DISCOVERY_TIME = 2.0  # s that nodes have to answer before the graph is taken as complete


def main(argv: list[str] | None = None) -> None:
    """ev-stack security_policies [--namespace /ev] [--check]"""
    parser = Parser(prog="security_policies", description=__doc__)
    parser.add_argument("--namespace", type=_namespace, default="/ev", help="of the nodes; default /ev")
    parser.add_argument(
        "--check", action="store_true", help="hold the running graph against it, status 1 if it does more"
    )
    given = parser.parse_args(argv)
    allowed = permissions(given.namespace)
    if not given.check:
        print(policy_file(given.namespace, allowed.values()), end="")
        return
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = Node("security_policies", start_parameter_services=False)
        time.sleep(_DISCOVERY_TIME)
        used = permissions_in_use(node, given.namespace)
    finally:
        rclpy.try_shutdown()
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


if __name__ == "__main__":
    main()
