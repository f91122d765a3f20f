"""Drivers whom other programs command: Autoware's vehicle interface, and ackermann_msgs.

How it works: the driver is an ordinary node with the law of commanded.py, which has places for the
command in its state. The node writes the newest command into that state between steps and reads
from it what it reports, so the law itself knows no messages.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message

from ev_doors.bridges import needed
from ev_msgs_py.contract import stamps
from ev_nodes.stepping.signal_io import Reader
from ev_nodes.stepping.stepped_node import SteppedNode

_LAW = str(Path(__file__).with_name("commanded.py"))
_EXCHANGE_PERIOD = 0.01  # s of wall time between looks for commands
_REPORT_PERIOD = stamps.from_seconds(0.02)  # ns of simulated time
_FASTEST = 1e3  # m/s
_AT_ONCE = 1e9  # m/s^2 or rad/s, where a command names no limit
_COMMANDS, _STATUS = "/control/command", "/vehicle/status"


class Language(Protocol):
    """The messages of commands and reports; they are loaded together with their node."""

    def report(self, stamp: Any, state: dict[str, float]) -> None:
        """Publish what the car does, at a stamp (sec, nanosec)."""


class CommandedDriver(SteppedNode):
    """Plays the driver by the newest command; ImportError if the language lacks its packages."""

    def __init__(
        self, language: Callable[[CommandedDriver], Language], **node_arguments: Any
    ) -> None:
        chosen = [
            *(node_arguments.pop("parameter_overrides", None) or ()),
            Parameter("method", value=_LAW),
        ]
        super().__init__("driver", parameter_overrides=chosen, **node_arguments)
        self._places = {
            name: place for place, name in enumerate(self.configuration.method.law.names())
        }
        self._inputs: list[tuple[Reader, type, Callable[[Any], dict[str, float]]]] = []
        self._reported = -_REPORT_PERIOD
        self._language = language(self)
        self.reports.warn("the driver is commanded from outside: the run is not reproducible")

    def follow(self, topic: str, kind: str, read: Callable[[Any], dict[str, float]]) -> None:
        """Have the newest message of a topic change the state by what `read` makes of it."""
        self._inputs.append(
            (Reader(self, needed(kind), topic, lambda _: None, None), needed(kind), read)
        )

    def take_steps(self, until: float, guard: int) -> bool:
        """Wait as every node does, but not for long: commands are waiting."""
        return super().take_steps(min(until, time.monotonic() + _EXCHANGE_PERIOD), guard)

    def sweep(self) -> None:
        """Take commands, too, and report."""
        super().sweep()
        for reader, kind, read in self._inputs:
            newest = None
            # Only the newest counts: each command holds until the next one.
            while (message := reader.take()) is not None:
                newest = message
            if newest is not None:
                self._obey(read(deserialize_message(newest, kind)))
        now = self.stepper.answered
        # A negative distance is a reset, behind which reports begin again at once.
        if now >= 0 and not 0 <= now - self._reported < _REPORT_PERIOD:
            self._reported = now
            sec, nanosec = divmod(now, stamps.NANOSECONDS)
            row = self.stepper.part.state
            self._language.report(
                (sec, nanosec), {name: float(row[place]) for name, place in self._places.items()}
            )

    def _obey(self, command: dict[str, float]) -> None:
        # All of a command or nothing: half of one would be none that was ever sent.
        wrong = [name for name, value in command.items() if not math.isfinite(value)]
        if wrong:
            self.reports.note(
                wrong[0],
                f"a command is refused: {wrong[0]} is {command[wrong[0]]}, expected a number",
            )
            return
        part = self.stepper.part
        state = [*part.state]  # in plain Python, and behind sensors and faults, this is a copy
        for name, value in command.items():
            state[self._places[name]] = value
        part.state = state

    @property
    def command_lasts(self) -> float:
        """Time for which a command holds [s]."""
        lasts: float = self.configuration.parameters.commands_last
        return lasts


class Ackermann:
    """AckermannDriveStamped of ackermann_msgs on `ackermann_cmd`; backwards by a negative speed.

    By the text of that message a limit of 0 means as fast as possible.
    """

    def __init__(self, node: CommandedDriver) -> None:
        self._node = node
        node.follow("ackermann_cmd", "ackermann_msgs/msg/AckermannDriveStamped", self._command)

    def _command(self, message: Any) -> dict[str, float]:
        drive = message.drive
        return {
            "wanted_speed": drive.speed,
            "lowest_speed": -_FASTEST,
            "highest_speed": _FASTEST,
            "acceleration": abs(drive.acceleration) or _AT_ONCE,
            "wanted_angle": drive.steering_angle,
            "angle_rate": abs(drive.steering_angle_velocity) or _AT_ONCE,
            "left": self._node.command_lasts,
        }

    def report(self, stamp: Any, state: dict[str, float]) -> None:
        """There are no reports: the topics of the graph have what the car does."""


class Autoware:
    """Bridge to Autoware.

    It reads Control and GearCommand, and writes VelocityReport, SteeringReport, GearReport and
    ControlModeReport.
    """

    def __init__(self, node: CommandedDriver) -> None:
        self._node = node
        self._modes: Any = needed("autoware_vehicle_msgs/msg/ControlModeReport")
        self._gears: Any = needed("autoware_vehicle_msgs/msg/GearReport")
        self._gear, self._was_commanded = int(self._gears.PARK), False
        node.follow(f"{_COMMANDS}/control_cmd", "autoware_control_msgs/msg/Control", self._command)
        node.follow(
            f"{_COMMANDS}/gear_cmd", "autoware_vehicle_msgs/msg/GearCommand", self._change_gear
        )
        self._to_rear_axle = node.configuration.common.vehicle.centre_of_mass_to_rear_axle
        self._velocity = self._publisher(node, "velocity_status", "VelocityReport")
        self._steering = self._publisher(node, "steering_status", "SteeringReport")
        self._gear_status = self._publisher(node, "gear_status", "GearReport")
        self._mode = self._publisher(node, "control_mode", "ControlModeReport")

    @staticmethod
    def _publisher(node: Node, name: str, kind: str) -> tuple[Any, type]:
        of = needed(f"autoware_vehicle_msgs/msg/{kind}")
        return node.create_publisher(of, f"{_STATUS}/{name}", 1), of

    def _command(self, message: Any) -> dict[str, float]:
        """The speed is followed as fast as the acceleration allows."""
        along, across = message.longitudinal, message.lateral
        has_rate = across.is_defined_steering_tire_rotation_rate
        self._was_commanded = True
        return {
            "wanted_speed": along.velocity,
            "acceleration": abs(along.acceleration) if along.is_defined_acceleration else _AT_ONCE,
            "wanted_angle": across.steering_tire_angle,
            "angle_rate": abs(across.steering_tire_rotation_rate) if has_rate else _AT_ONCE,
            "left": self._node.command_lasts,
        }

    def _change_gear(self, message: Any) -> dict[str, float]:
        """Drive, however far, and low go forwards; NONE changes nothing."""
        gear, of = int(message.command), self._gears
        # An empty command changes nothing, also not the gear that is reported.
        if gear == of.NONE or gear > of.LOW_2:
            return {}
        self._gear = gear
        backwards = gear in (of.REVERSE, of.REVERSE_2)
        return {
            "lowest_speed": -_FASTEST if backwards else 0.0,
            "highest_speed": 0.0 if backwards or gear in (of.PARK, of.NEUTRAL) else _FASTEST,
            "in_neutral": float(gear == of.NEUTRAL),
        }

    def report(self, stamp: Any, state: dict[str, float]) -> None:
        """Report velocities of the middle of the rear axle, Autoware's origin of a vehicle."""
        modes = self._modes
        mode = modes.AUTONOMOUS if state["held"] == 1.0 else modes.NOT_READY
        # Not ready before the first command; without a fresh one after that, disengaged.
        if mode == modes.NOT_READY and self._was_commanded:
            mode = modes.DISENGAGED
        # v_y at the rear axle, b behind the centre of mass: v_y - b r. The longitudinal one is the
        # same.
        lateral = state["lateral"] - self._to_rear_axle * state["yaw_rate"]
        self._send(
            self._velocity,
            stamp,
            longitudinal_velocity=state["longitudinal"],
            lateral_velocity=lateral,
            heading_rate=state["yaw_rate"],
        )
        self._send(self._steering, stamp, steering_tire_angle=state["road_wheel_angle"])
        self._send(self._gear_status, stamp, report=self._gear)
        self._send(self._mode, stamp, mode=int(mode))

    @staticmethod
    def _send(to: tuple[Any, type], stamp: Any, **content: Any) -> None:
        publisher, kind = to
        message: Any = kind(**content)
        # Some of these messages have a header, others only a stamp.
        if hasattr(message, "header"):
            message.header.frame_id = "base_link"
        place = message.header.stamp if hasattr(message, "header") else message.stamp
        place.sec, place.nanosec = stamp
        publisher.publish(message)
