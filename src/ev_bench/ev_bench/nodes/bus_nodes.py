"""Nodes on a CAN bus in real time: frames as they come, and a cycle every millisecond.

`BusNode` has nothing but its bus, `RoleOnBus` plays a role of the graph besides.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

from rclpy.node import Node

from ev_bench.bus.channel import Channels
from ev_bench.bus.parameters import BusParameters, load_database
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import bare, behind_sensors
from ev_core.methods.part import Part, PythonPart
from ev_core.parameters.declaration import entries
from ev_core.parameters.values import build, replaced
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import TICK
from ev_nodes.stepping import ros_parameters
from ev_nodes.stepping.reports import Reports
from ev_nodes.stepping.spinning import Spinnable
from ev_nodes.stepping.stepped_node import SteppedNode

_MOST_REPORTED = 10  # troubles that are reported


class Ticks:
    """Begins to count when it is made; the clock is monotonic."""

    def __init__(self) -> None:
        self._start, self._counted = time.monotonic(), 0

    def passed(self) -> int:
        """Ticks since the last call; many, if the process was held up."""
        # From the start and not from the last call, so that what is rounded off does not add up.
        passed = int((time.monotonic() - self._start) / TICK) - self._counted
        self._counted += passed
        return passed

    def until_next(self) -> float:
        """Seconds until the next one."""
        return max(self._start + (self._counted + 1) * TICK - time.monotonic(), 0.0)


class WithBus(Spinnable):
    """Takes frames as they come and makes a cycle every millisecond, whatever else the node is.

    A subclass defines what a frame and a cycle mean.
    """

    channels: Channels | None = None  # before they are open, and after they were closed
    reports: Reports
    _ticks: Ticks

    def begin(self, channels: Channels) -> None:
        """Frames are taken, and time counts, from now on."""
        self.channels, self._ticks, self._reported = channels, Ticks(), set[str]()

    def take(self, circuit: str, frame: Frame) -> None:
        """A frame has come on the channel of a circuit."""
        raise NotImplementedError

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Some ticks have passed; circuit and frame of all that is to be sent."""
        raise NotImplementedError

    def poll(self) -> bool:
        """Take all frames, and make a cycle if one is due; False if there was nothing to do."""
        if self.channels is None:
            return False
        ticks, progressed = self._ticks.passed(), False
        # it was held up: what waits on the bus came late, and shall not count as if it had not
        if ticks > 1:
            self._make(self.channels, ticks)
        for circuit, frame in self.channels.received():
            self.take(circuit, frame)
            progressed = True
        # In time: what has come counts in this cycle.
        if ticks == 1:
            self._make(self.channels, ticks)
        return progressed

    def _make(self, channels: Channels, ticks: int) -> None:
        for circuit, frame in self.cycle(ticks):
            channels.send(circuit, frame)

    def wake_up_within(self) -> float:
        """Seconds until the next cycle."""
        return self._ticks.until_next() if self.channels else 0.0

    def idle(self) -> None:
        """Say once what goes wrong on the bus."""
        for trouble in self.channels.troubles() if self.channels else ():
            if trouble not in self._reported and len(self._reported) < _MOST_REPORTED:
                self._reported.add(trouble)
                self.reports.warn(trouble)

    def close(self) -> None:
        """Leave the bus."""
        if self.channels is not None:
            self.channels.close()
            self.channels = None


class BusNode(WithBus, Node):
    """A node of a bus alone; how it is run, see `spinning`.

    ParameterError, BusError or OSError if it cannot be made.
    """

    def __init__(self, name: str, parameters: type, **node_arguments: Any) -> None:
        super().__init__(
            name, automatically_declare_parameters_from_overrides=True, **node_arguments
        )
        self.parameters: Any = build(parameters, ros_parameters.given(self, node_arguments))
        ros_parameters.follow(self, entries(self.parameters), self._take_over)
        self.database: Database = load_database(self.parameters.bus.database)
        self.reports = Reports(self, name)
        self.prepare()
        bus: BusParameters = self.parameters.bus
        self.begin(Channels(bus, bus.log))
        self.every(TICK, self.poll)

    def prepare(self) -> None:
        """Make what frames and cycles need, before the bus is open."""
        raise NotImplementedError

    def close(self) -> None:
        """Leave the bus, and hang up."""
        super().close()
        self.reports.runner.close()

    def changed(self) -> None:
        """Other parameters were taken over."""
        raise NotImplementedError

    def _take_over(self, given: dict[str, Any]) -> None:
        before = self.parameters
        try:
            self.parameters = replaced(before, given)
            self.changed()
        except Exception:  # by what it raises nothing shall be half changed
            self.parameters = before
            self.changed()
            raise


class RoleOnBus(WithBus, SteppedNode):
    """Node that makes cycles of 1 ms by the wall clock, besides the steps of every node.

    A subclass makes what plays its role (`played_by`): an object that steps or advances, with
    `receive(circuit, frame)` and `cycle(ticks)` for the bus, and `go_on_from(other)` where
    parameters change.
    """

    def __init__(self, *arguments: Any, **node_arguments: Any) -> None:
        super().__init__(*arguments, **node_arguments)
        self.begin(self.open_channels())

    def played_by(self, configuration: Configuration) -> Any:
        """Player of the role, at rest."""
        raise NotImplementedError

    def open_channels(self) -> Channels:
        """The channels of its bus; BusError, ValueError or OSError if they cannot be had."""
        raise NotImplementedError

    def new_part(self, configuration: Configuration, may_wait: bool = True) -> Part:
        """Player of the role, behind its sensors."""
        return behind_sensors(
            configuration, PythonPart(configuration.method, self.played_by(configuration))
        )

    def successor(self, configuration: Configuration, changed: Iterable[str] = ()) -> Part:
        """Go on with other parameters in the midst of a period, with what has come over the bus."""
        part = super().successor(configuration, changed)
        # Before its first answer it has nothing to go on from.
        if self.stepper.answer is not None:
            bare(part).made.go_on_from(self.player)
        return part

    @property
    def player(self) -> Any:
        """Present player of the role."""
        return bare(self.stepper.part).made

    def take(self, circuit: str, frame: Frame) -> None:
        """A frame has come on the channel of a circuit."""
        self.player.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Some ticks have passed; circuit and frame of all that is to be sent."""
        frames: list[tuple[str, Frame]] = self.player.cycle(ticks)
        return frames

    def close(self) -> None:
        """Leave the bus, and report the sums to the runner."""
        WithBus.close(self)
        SteppedNode.close(self)

    def poll(self) -> bool:
        """Take frames and messages; False if there was nothing to do."""
        frames = WithBus.poll(self)
        return SteppedNode.poll(self) or frames
