"""Policies for DDS security: written, and held against the running graph."""

from __future__ import annotations

import argparse
import sys

from rclpy.exceptions import InvalidNamespaceException
from rclpy.validate_namespace import validate_namespace

from ev_doors.security.permissions import permissions, permissions_in_use, policy_file, violations
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.commands.present_graph import in_the_graph
from ev_stack.recording.outcome import RunFailed

_ABOUT_POLICIES = (
    "Write the policy file of the graph for DDS security, or hold the running graph against it."
)


def policies(argv: list[str]) -> None:
    """ev-stack security_policies [--namespace /ev] [--check]"""
    parser = Parser(prog="security_policies", description=_ABOUT_POLICIES)
    parser.add_argument(
        "--namespace", type=_namespace, default="/ev", help="of the nodes; default /ev"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="hold the running graph against it, status 1 if it does more",
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
    print(
        f"{len(used)} nodes, {len(found)} things that the policy does not allow", *found, sep="\n"
    )
    sys.exit(bool(found))


def _namespace(text: str) -> str:
    namespace = text.rstrip("/")
    try:
        validate_namespace(namespace or "/")
    except InvalidNamespaceException as error:
        raise argparse.ArgumentTypeError(str(error).splitlines()[0]) from None
    return namespace
