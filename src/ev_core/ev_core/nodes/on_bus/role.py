"""A role of the graph whose frames go over a real CAN bus, in real time."""

from __future__ import annotations

from typing import Any

from ev_core.bus.channel import Frame
from ev_core.bus.channels import Channels
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import bare, behind_sensors
from ev_core.methods.part import Part, PythonPart
from ev_core.nodes.on_bus.cycles import BusCycles, WithBus
from ev_core.nodes.stepped_node import SteppedNode


class RoleOnBus(WithBus, SteppedNode):
    """Steps as every node does, and besides makes cycles of 1 ms by the wall clock, with frames in and out.

    A subclass says by what its role is played (`played_by`): an object that steps or advances, with `receive(circuit,
    frame)` and `cycle(ticks)` for the bus.
    """

    def __init__(self, *arguments: Any, **node_arguments: Any) -> None:
        super().__init__(*arguments, **node_arguments)
        self._bus = BusCycles(self.open_channels(), self, self.reports.warn)

    def played_by(self, configuration: Configuration) -> Any:
        """What plays the role, at rest."""
        raise NotImplementedError

    def open_channels(self) -> Channels:
        """The channels that it speaks on; BusError, ValueError or OSError if they cannot be had."""
        raise NotImplementedError

    def new_part(self, configuration: Configuration) -> Part:
        """What plays the role, behind its sensors."""
        return behind_sensors(configuration, PythonPart(configuration.method, self.played_by(configuration)))

    @property
    def player(self) -> Any:
        """What plays the role now."""
        return bare(self.stepper.part).made

    def take(self, circuit: str, frame: Frame) -> None:
        """A frame has come on the channel of a circuit."""
        self.player.receive(circuit, frame)

    def cycle(self, ticks: int) -> list[tuple[str, Frame]]:
        """Some ticks have passed; circuit and frame of all that is to be sent."""
        frames: list[tuple[str, Frame]] = self.player.cycle(ticks)
        return frames

    def close(self) -> None:
        """Leave the bus, and tell the runner what was said."""
        WithBus.close(self)
        SteppedNode.close(self)

    def poll(self) -> bool:
        """Take frames and messages; False if there was nothing to do."""
        frames = self._bus is not None and self._bus.poll()
        return super().poll() or frames
