"""The newest numbers of all topics of a running graph as one row, and reports of /diagnostics.

The graph knows the node of a report, and any node may take that name.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import PLACES, SIZE, TIME
from ev_msgs_py.contract.roles import MASTER, RECORDER, ROLES
from ev_msgs_py.contract.signals import BodyVelocity
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, shown
from ev_msgs_py.wire import MessageError, format_of
from ev_nodes.stepping import runner_line
from ev_nodes.stepping.reports import HEALTH, NOTED
from ev_nodes.stepping.signal_io import HELD, Reader, SignalReader
from ev_stack.recording.recording import Recording, recording_of
from ev_stack.report.page.plot_groups import groups_of
from ev_stack.views.car import PREFIX, car_of, vehicle_in, view_channels

_MOST = 1000  # different ones that are remembered
# Of the messages between two looks only the last one counts. A lost one is sent again: while time
# is paused no other one follows.
_NEWEST = QoSProfile(depth=1)
# of the master, at every instant: one topic never goes back, several overtake each other
_TELLS_TIME = BodyVelocity


class Reported:
    """Takes the reports of nodes with the names of roles."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._reported: set[str] = set()
        self._new: list[tuple[str, bool]] = []
        self._names: dict[bytes, tuple[str, str]] = {}  # namespace and name by publisher
        self._reader = Reader(node, DiagnosticArray, "/diagnostics", self._note, self)

    def look(self) -> list[tuple[str, bool]]:
        """Take the reports since the last look, with a mark of those about time alone."""
        while (message := self._reader.take(HELD)) is not None:
            self._reader.receive(message)
        new, self._new = self._new, []
        return new

    def admits(self, gid: bytes) -> bool:
        """Mark of a report by a node that the graph knows under the name of a role."""
        # Asked of the graph only where a publisher is new: the answer costs a look at all of them.
        if gid not in self._names:
            self._names = {
                bytes(end.endpoint_gid): (end.node_namespace, end.node_name)
                for end in self._node.get_publishers_info_by_topic("/diagnostics")
            }
        space, name = self._names.get(gid, ("", ""))
        return space == self._node.get_namespace() and name in (*ROLES, RECORDER)

    def _note(self, message: bytes) -> None:
        with suppress(RuntimeError):  # what cannot be read
            for status in deserialize_message(message, DiagnosticArray).status:
                self._note_status(status)

    def _note_status(self, status: DiagnosticStatus) -> None:
        if (
            status.name.endswith((HEALTH, runner_line.TIMING)) or status.hardware_id
        ):  # of a device: its node notes what is latched
            return
        text, about_time = (
            shown(f"{status.name}: {status.message}"),
            status.name.endswith(runner_line.TIME_SERVICE),
        )
        what = next((shown(value.value) for value in status.values if value.key == NOTED), text)
        if about_time or (what not in self._reported and len(self._reported) < _MOST):
            self._reported.add(what)
            self._new.append((text, about_time))


class _NewestReader(SignalReader):
    quality = _NEWEST


class _Refusals:
    """Hands all reports on publishers that are not admitted to one function."""

    def __init__(self, refuse: Callable[[str, str], None]) -> None:
        self.note = refuse

    def warn_once(self, what: str, text: str) -> None:
        """Report several nodes of one name."""
        self.note(what, text)


class LiveFrames:
    """Reader of all topics; it calls `refuse` with the cause of a message that is not taken.

    With the `vehicle` of the plant the rows also hold what the car seen from above needs.
    """

    def __init__(self, node: Node, refuse: Callable[[str, str], None]) -> None:
        self.vehicle: Vehicle | None = None
        self._refuse = refuse
        refusals = _Refusals(refuse)
        self._readers = {
            signal: _NewestReader(node, TOPICS[signal], lambda message: None, refusals)
            for signal in PLACES
        }
        self._numbers = np.zeros((1, SIZE))
        self._stamp: int | None = None
        self._period = 0  # ns; 0 until the parameters of the plant are known
        self._heard: list[type] = []
        self._shown: dict[str, np.ndarray] = {}

    @property
    def time(self) -> float:
        """The newest instant [s]; stamps of a run behind a reset are above theirs."""
        return float(self._numbers[0, TIME])

    def look(self) -> bool:
        """Take what has come; whether there is another instant than at the last look."""
        newest: int | None = None
        for signal, reader in self._readers.items():
            message = None
            while (taken := reader.take()) is not None:
                message = taken
            if message is None:
                continue
            try:
                stamp, numbers = format_of(signal).read(message)
            except MessageError as error:
                self._refuse(TOPICS[signal].name, f"{TOPICS[signal].name} is refused: {error}")
                continue
            self._numbers[0, PLACES[signal]] = numbers
            if signal is _TELLS_TIME:
                newest = stamp
            # In the order of the frame, not of arrival, so that columns do not depend on luck.
            if signal not in self._heard:
                self._heard = [each for each in PLACES if each in self._heard or each is signal]
        # The master repeats a state that was not answered: no other instant.
        if newest is None or newest == self._stamp:
            return False
        self._stamp = newest
        # The rest above a multiple of the period is the number of the run, no time.
        self._numbers[0, TIME] = stamps.to_seconds(
            newest - newest % self._period if self._period else newest
        )
        self._shown = self._channels()
        return True

    def take_car(self, message: Mapping[str, Any]) -> None:
        """Take car and control period over where `Controls` gives the parameters of the plant."""
        if (message["kind"], message.get("node")) != ("node", MASTER):
            return
        values = {each["name"]: each["value"] for each in message["parameters"]}
        self._period = stamps.from_seconds(values["control_period"])
        try:
            self.vehicle = vehicle_in(values)
        except ParameterError as error:
            self._refuse(str(error), f"the car cannot be shown: {error}")

    @property
    def columns(self) -> list[str]:
        """The channels of a row, after the time."""
        return [*self._shown]

    def layout(self) -> dict[str, Any]:
        """The message that lays a page out for its rows."""
        return layout_message(self.columns, self.vehicle)

    @property
    def values(self) -> dict[str, float]:
        """Every channel of the newest instant."""
        return {name: float(value[0]) for name, value in self._shown.items()}

    def row(self) -> bytes:
        """Time and channels as float64 in the byte order of this machine and its browsers."""
        return array("d", [self.time, *self.values.values()]).tobytes()

    def _channels(self) -> dict[str, np.ndarray]:
        run = self.recording
        return {**run.channels, **(view_channels(run, self.vehicle) if self.vehicle else {})}

    @property
    def recording(self) -> Recording:
        """The newest instant alone."""
        return recording_of(self._numbers, [TOPICS[signal] for signal in self._heard])


def layout_message(columns: Sequence[str], vehicle: Vehicle | None) -> dict[str, Any]:
    """Build the message of the channels of a row, how they are plotted together, and the car."""
    plotted = [name for name in columns if not name.startswith(PREFIX)]
    car = None if vehicle is None else car_of(vehicle)
    return {"kind": "layout", "channels": [*columns], "groups": groups_of(plotted), "car": car}
