"""Feedback of one inverter: checked frame by frame, and kept as far as it is valid."""

from __future__ import annotations

from collections.abc import Mapping

from ev_control.inverter_gateway.state import Feedback
from ev_msgs_py.can.channel import Frame
from ev_msgs_py.can.checking import (
    REPEATED,
    TOLERANCES,
    WRONG_CRC,
    WRONG_SEQUENCE,
    CheckState,
    check,
    is_valid,
    no_new_data,
)
from ev_msgs_py.can.conventions import RPM
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.drive_states import state_of
from ev_msgs_py.can.faults import FAULTS, WARNINGS
from ev_msgs_py.can.frame_layout import FrameLayout

_REFUSED = (WRONG_CRC, REPEATED, WRONG_SEQUENCE)


class Hearing:
    """Takes the frames of one device."""

    def __init__(self, database: Database, device: str, s: Feedback) -> None:
        self._s = s
        self._kinds: dict[int, tuple[FrameLayout, CheckState]] = {}
        self._takers = {"Motion": self._motion, "Electrical": self._electrical, "Temperatures": self._temperatures,
                        "Faults": self._faults}  # fmt: skip
        for kind in self._takers:
            layout = database[f"{device}_{kind}"]
            self._kinds[layout.identifier] = (layout, getattr(s, kind.lower()))

    def receive(self, frame: Frame) -> None:
        """Take a frame of this device, if it is one; what is not valid is counted."""
        if frame.identifier not in self._kinds:
            return
        layout, state = self._kinds[frame.identifier]
        if len(frame.data) != layout.length:
            self._s.refused += 1.0
            return
        payload = int.from_bytes(frame.data, "little")
        status = check(TOLERANCES, state, payload, layout.length, layout.data_id)
        if state is self._s.motion:
            self._s.heard = 1.0
        if is_valid(status):
            self._s.lost += state.lost_data
            self._takers[layout.name.partition("_")[2]](layout.values(payload))
        elif status in _REFUSED:
            self._s.refused += 1.0

    def end_cycle(self) -> None:
        """Tell the check of the fastest frame when none has come since the last call."""
        if self._s.heard == 0.0:
            no_new_data(self._s.motion)
        self._s.heard = 0.0

    def _motion(self, values: Mapping[str, float]) -> None:
        s = self._s
        s.age, s.state = 0.0, float(state_of(int(values["Statusword"])))
        s.torque, s.speed = values["Torque"], RPM * values["Speed"]

    def _electrical(self, values: Mapping[str, float]) -> None:
        s = self._s
        s.dc_voltage, s.dc_current, s.phase_current = values["DcVoltage"], values["DcCurrent"], values["PhaseCurrent"]

    def _temperatures(self, values: Mapping[str, float]) -> None:
        self._s.winding_temperature, self._s.inverter_temperature = values["Winding"], values["Inverter"]

    def _faults(self, values: Mapping[str, float]) -> None:
        self._s.fault_bits = float(sum(int(values[f.name]) << place for place, f in enumerate(FAULTS)))
        self._s.warning_bits = float(sum(int(values[name]) << place for place, name in enumerate(WARNINGS)))
        self._s.error_code = values["ErrorCode"]
