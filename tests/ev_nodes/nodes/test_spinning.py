"""Running of nodes."""

from __future__ import annotations

import pytest
from helpers.ros_graph import ros_domain
from rclpy.node import Node

from ev_msgs_py.refusal import ParameterError
from ev_nodes.node_loop import ordinary_steps
from ev_nodes.stepping.spinning import spin


class Besieged(Node):
    """A node for which something has always come."""

    polling_place = 0
    swept = 0

    def poll(self) -> bool:
        return True

    def take_steps(self, until: float, guard: int) -> bool:
        return False

    def sweep(self) -> None:
        self.swept += 1

    def awaits(self) -> None:
        return None

    def wake_up_within(self) -> float:
        return 0.0

    def idle(self) -> None:
        raise AssertionError("something has come")


def test_a_node_for_which_something_always_comes_hears_the_rest_too():
    """Endless messages on one topic leave the others their turn, such as the recorder's."""
    with ros_domain() as context:
        node = Besieged("besieged", context=context)
        turns = iter(range(1_000_000))
        spin([node], lambda: node.swept > 2 or next(turns) > 900_000)
        assert node.swept > 2
        node.destroy_node()


@pytest.mark.parametrize("given", ["2", "", "off"])
def test_only_0_and_1_say_whether_nodes_have_their_loop(given: str, monkeypatch):
    monkeypatch.setenv(ordinary_steps.VARIABLE, given)
    with pytest.raises(
        ParameterError, match=f"^EV_STACK_NODE_LOOP='{given}' is refused, expected 1, or 0 "
    ):
        ordinary_steps.is_switched_on()
