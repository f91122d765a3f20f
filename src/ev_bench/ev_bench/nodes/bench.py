"""The node of the role test_bench: services lead it through the test sequence."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from ev_bench.machines.sequence import OBJECTS, SEQUENCE_STEPS, Sequence, begun
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.part import Part
from ev_nodes.run_role import given_parameters, run_node
from ev_nodes.stepping.stepped_node import SteppedNode

_ROLE, _ENABLED = "test_bench", "enabled"


class TestBenchNode(SteppedNode):
    """Node of the bench, with a service for each step and one for the emergency switch."""

    __test__ = False
    sequence = Sequence()

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(_ROLE, **node_arguments)
        self.sequence = begun(self.configuration.values()[_ENABLED])
        for step in SEQUENCE_STEPS[1:]:
            self._serve(step, partial(self._after, step))
        for chosen in OBJECTS:
            self._serve(f"choose_{chosen}", partial(self._after, "choose", chosen))
        self._serve("emergency_stop", lambda: self.sequence.stopped())

    def successor(self, configuration: Configuration, changed: Iterable[str] = ()) -> Part:
        """Go on with other parameters; ValueError if they enable what the switch has disabled."""
        if self.sequence.emergency and configuration.values()[_ENABLED] != "none":
            raise ValueError(
                f"{_ENABLED} is refused after an emergency stop, expected none until disconnect"
            )
        return super().successor(configuration, changed)

    def reconfigured(self) -> None:
        """Follow the parameter that enables circuits to its place in the sequence."""
        enabled = self.configuration.values()[_ENABLED]
        if enabled != self.sequence.enabled:
            self.sequence = begun(enabled)

    def _serve(self, name: str, change: Callable[[], Sequence]) -> None:
        self.create_service(Trigger, f"~/{name}", partial(self._answer, change))

    def _after(self, step: str, chosen: str = "both") -> Sequence:
        return self.sequence.after(step, self.configuration.values()["cooling"], chosen)

    def _answer(self, change: Callable[[], Sequence], _request: Any, response: Any) -> Any:
        """Change the sequence and with it the parameter `enabled`, or give the reason."""
        try:
            sequence = change()
        except ValueError as error:
            response.success, response.message = False, str(error)
            return response
        # The sequence is where the parameter is: it goes on only if that was taken over.
        result = self.set_parameters_atomically([Parameter(_ENABLED, value=sequence.enabled)])
        response.success, response.message = result.successful, result.reason
        if result.successful:
            self.sequence = sequence
            response.message = f"enabled: {sequence.enabled}"
        return response


def make(**node_arguments: Any) -> SteppedNode:
    """The node: in real time behind a bus it uses that, else bus or none are within the graph."""
    with given_parameters(_ROLE, **node_arguments) as given:
        if given.get("mode") == "realtime" and given.get("method") == "circuits_on_can":
            # it needs python-can, which others do without
            from ev_bench.nodes.inverter import OnBus

            # The bus comes first among the bases: it has another player of the role.
            return type("TestBenchOnBus", (OnBus, TestBenchNode), {})(**node_arguments)
        return TestBenchNode(**node_arguments)


def main() -> None:
    """ros2 run ev_bench test_bench"""
    run_node(_ROLE, make)
