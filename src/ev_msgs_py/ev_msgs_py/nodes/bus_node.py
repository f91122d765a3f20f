"""The common part of nodes that speak on a CAN bus: parameters, channels, and cycles by the wall clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter

from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.channels import Channels
from ev_msgs_py.can.database import Database, load_database
from ev_msgs_py.can.schedule import TICK
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.nodes import ros_parameters
from ev_msgs_py.nodes.reports import Reports
from ev_msgs_py.nodes.run_role import make_node
from ev_msgs_py.nodes.ticks import Ticks
from ev_msgs_py.parameters.declaration import ParameterError, entries
from ev_msgs_py.parameters.values import build, replaced


class BusNode(Node):
    """Takes frames as they come and makes a cycle every millisecond; how it is run, see `spinning`.

    A subclass says what a frame and a cycle mean. ParameterError, BusError or OSError if it cannot be made.
    """

    done = False
    polling_place = len(ROLES)
    channels: Channels | None = None

    def __init__(self, name: str, parameters: type, **node_arguments: Any) -> None:
        super().__init__(name, automatically_declare_parameters_from_overrides=True, **node_arguments)
        self.parameters: Any = build(parameters, ros_parameters.overrides(self))
        ros_parameters.declare(self, entries(self.parameters))
        self.database: Database = load_database(self.parameters.bus.database)
        self.reports = Reports(self, name)
        self._said: set[str] = set()
        self.prepare()
        self.channels = Channels(self.parameters.bus)
        self.add_on_set_parameters_callback(self._on_set)
        self._ticks = Ticks()
        # For rclpy's own executors; `spinning.spin` polls by itself.
        self.create_timer(TICK, self._look, clock=RosClock(clock_type=ClockType.STEADY_TIME))

    def _look(self) -> None:
        self.poll()

    def prepare(self) -> None:
        """Make what frames and cycles need, before the bus is open."""
        raise NotImplementedError

    def take(self, circuit: str, frame: Frame) -> None:
        """A frame has come on the channel of a circuit."""
        raise NotImplementedError

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Some ticks have passed; circuit and frame of all that is to be sent."""
        raise NotImplementedError

    def changed(self) -> None:
        """Other parameters were taken over."""
        raise NotImplementedError

    def poll(self) -> bool:
        """Take all frames, and make a cycle if one is due; False if there was nothing to do."""
        if self.channels is None:
            return False
        ticks, progressed = self._ticks.passed(), False
        if ticks > 1:  # it was held up: what waits on the bus came late, and shall not count as if it had not
            self._make(self.channels, ticks)
        for circuit, frame in self.channels.received():
            self.take(circuit, frame)
            progressed = True
        if ticks == 1:
            self._make(self.channels, ticks)
        return progressed

    def _make(self, channels: Channels, ticks: int) -> None:
        for circuit, frame in self.cycle(ticks):
            channels.send(circuit, frame)

    def take_steps(self, until: float) -> bool:
        """Its steps are cycles by the wall clock."""
        return False

    def sweep(self) -> None:
        """Nothing more to take: `poll` takes everything."""

    def awaits(self) -> None:
        """No message wakes it up: it looks every millisecond."""

    def wake_up_within(self) -> float:
        """Seconds until the next cycle."""
        return self._ticks.until_next()

    def idle(self) -> None:
        """Say once what goes wrong on the bus."""
        for trouble in self.channels.troubles() if self.channels else ():
            if trouble not in self._said and len(self._said) < 10:
                self._said.add(trouble)
                self.reports.warn(trouble)

    def close(self) -> None:
        """Leave the bus."""
        if self.channels is not None:
            self.channels.close()
            self.channels = None

    def _on_set(self, changes: list[Parameter]) -> SetParametersResult:
        given = {change.name: change.value for change in changes if not ros_parameters.is_ros_own(change.name)}
        try:
            self.parameters = replaced(self.parameters, given)
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        if given:
            self.changed()
        return SetParametersResult(successful=True)


def on_bus_or_in_graph(role: str, on_bus: Callable[[], Node]) -> Any:
    """The node of a role: in a run, whose runner names the method, or in lockstep, frames are signals of the graph.

    Else it is one that speaks on a bus, which knows neither.
    """
    asked = Node(role, automatically_declare_parameters_from_overrides=True)
    told = ros_parameters.overrides(asked)
    asked.destroy_node()
    return make_node(role) if "method" in told or told.get("mode") == "lockstep" else on_bus()
