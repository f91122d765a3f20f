"""An observer of a node's inputs stays in the graph until the node has them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from helpers.ros_graph import ros_domain

from ev_bench.nodes import bench, gateway
from ev_nodes import run_role


@pytest.mark.parametrize("make", [gateway.make, bench.make], ids=["inverter_gateway", "test_bench"])
def test_the_context_stays_in_the_graph_when_the_asking_node_goes(
    make: Callable[..., Any], monkeypatch
):
    """A context leaves the graph with its last node; Fast DDS may then lock starting ones."""
    others = []

    class Asking(run_role.Node):
        def destroy_node(self) -> None:
            others.append(set(self.get_node_names()) - {self.get_name()})
            super().destroy_node()

    monkeypatch.setattr(run_role, "Node", Asking)
    with ros_domain() as context:
        node = make(context=context)
        assert others == [{f"_{node.get_name()}"}, {node.get_name()}]
        assert node.get_node_names() == [node.get_name()]
        node.close()
        node.destroy_node()
