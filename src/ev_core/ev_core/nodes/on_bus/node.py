"""The common part of nodes that speak on a CAN bus: parameters, channels, and cycles by the wall clock."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter

from ev_core.bus.channel import Frame
from ev_core.bus.channels import Channels
from ev_core.bus.database_file import load_database
from ev_core.bus.parameters import BusParameters
from ev_core.nodes import ros_parameters
from ev_core.nodes.on_bus.cycles import BusCycles, WithBus
from ev_core.nodes.reports import Reports
from ev_core.parameters.declaration import entries
from ev_core.parameters.values import build, replaced
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frames import TICK
from ev_msgs_py.contract.roles import ROLES


class BusNode(WithBus, Node):
    """Takes frames as they come and makes a cycle every millisecond; how it is run, see `spinning`.

    A subclass says what a frame and a cycle mean. ParameterError, BusError or OSError if it cannot be made.
    """

    done = False
    polling_place = len(ROLES)

    def __init__(self, name: str, parameters: type, **node_arguments: Any) -> None:
        super().__init__(name, automatically_declare_parameters_from_overrides=True, **node_arguments)
        self.parameters: Any = build(parameters, ros_parameters.given(self, node_arguments))
        ros_parameters.declare(self, entries(self.parameters))
        self.database: Database = load_database(self.parameters.bus.database)
        self.reports = Reports(self, name)
        self.prepare()
        bus: BusParameters = self.parameters.bus
        self._bus = BusCycles(Channels(bus, bus.log), self, self.reports.warn)
        self.add_on_set_parameters_callback(self._on_set)
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

    def close(self) -> None:
        """Leave the bus, and hang up."""
        super().close()
        self.reports.runner.close()

    def changed(self) -> None:
        """Other parameters were taken over."""
        raise NotImplementedError

    def poll(self) -> bool:
        """Take all frames, and make a cycle if one is due; False if there was nothing to do."""
        return self._bus is not None and self._bus.poll()

    @property
    def channels(self) -> Channels | None:
        """What it speaks on; None before it is open and after it was closed."""
        return self._bus.channels if self._bus else None

    def take_steps(self, until: float, guard: int) -> bool:
        """Its steps are cycles by the wall clock."""
        return False

    def sweep(self) -> None:
        """Nothing more to take: `poll` takes everything."""

    def awaits(self) -> None:
        """No message wakes it up: it looks every millisecond."""

    def _on_set(self, changes: list[Parameter]) -> SetParametersResult:
        before = self.parameters
        try:
            self.parameters = replaced(before, ros_parameters.asked_for(changes))
            self.changed()
        except Exception as error:  # by what it raises nothing shall be half changed
            self.parameters = before
            self.changed()
            return ros_parameters.refusal(error)
        return SetParametersResult(successful=True)
