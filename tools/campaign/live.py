"""Asks a node of a run to take a bad parameter: ROLE NAME SEED."""

from __future__ import annotations

import random
import sys

import rclpy
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

_SECONDS = 5.0
VALUES = (
    float("nan"),
    float("inf"),
    -1e308,
    1e308,
    "",
    "no such thing",
    True,
    [1.0, float("nan")],
    ["a"],
    -1,
    10**18,
)


def main() -> None:
    """Ask some times, with bad values one after the other."""
    role, name, seed = sys.argv[1:4]
    chance = random.Random(int(seed))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node("setter", namespace="/ev")
    client = node.create_client(SetParameters, f"/ev/{role}/set_parameters")
    if client.wait_for_service(timeout_sec=_SECONDS):
        for value in chance.sample(VALUES, 4):
            asked = SetParameters.Request(
                parameters=[Parameter(name, value=value).to_parameter_msg()]
            )
            rclpy.spin_until_future_complete(node, client.call_async(asked), timeout_sec=1.0)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
