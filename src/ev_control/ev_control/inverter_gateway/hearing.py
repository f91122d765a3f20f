"""Feedback of one inverter: checked frame by frame, and kept as far as it is valid."""

from __future__ import annotations

from ev_control.inverter_gateway.state import Feedback
from ev_core.bus.checking import (
    REPEATED,
    TOLERANCES,
    WRONG_CRC,
    WRONG_SEQUENCE,
    CheckState,
    check,
    is_valid,
    no_new_data,
)
from ev_msgs_py.can.drive_states import REMOTE, state_of
from ev_msgs_py.can.frames import RPM, SENT, BenchFrames, DeviceFrames
from ev_msgs_py.can.payload import extracted
from ev_msgs_py.compilable import compilable

MOTION, ELECTRICAL, TEMPERATURES, FAULTS = range(len(SENT))


@compilable
def receive_feedback(f: BenchFrames, own: DeviceFrames, s: Feedback, kind: int, payload: int) -> None:
    """Take a frame of this device; what is not valid is counted."""
    data_id = own.data_ids[kind]
    if kind == MOTION:
        s.heard = 1.0
        if _is_good(s, s.motion, payload, f.motion.length, data_id):
            word = int(extracted(payload, f.motion.statusword))
            s.age, s.state, s.remote = 0.0, float(state_of(word)), 1.0 if word & REMOTE != 0 else 0.0
            s.torque = extracted(payload, f.motion.torque)
            s.torque_sum += s.torque
            s.torque_count += 1.0
            s.speed = RPM * extracted(payload, f.motion.speed)
    elif kind == ELECTRICAL:
        if _is_good(s, s.electrical, payload, f.electrical.length, data_id):
            s.dc_voltage = extracted(payload, f.electrical.dc_voltage)
            s.dc_current = extracted(payload, f.electrical.dc_current)
            s.phase_current = extracted(payload, f.electrical.phase_current)
    elif kind == TEMPERATURES:
        if _is_good(s, s.temperatures, payload, f.temperatures.length, data_id):
            s.winding_temperature = extracted(payload, f.temperatures.winding)
            s.inverter_temperature = extracted(payload, f.temperatures.inverter)
    elif _is_good(s, s.faults, payload, f.faults.length, data_id):
        s.fault_bits = extracted(payload, f.faults.faults)
        s.warning_bits = extracted(payload, f.faults.warnings)
        s.error_code = extracted(payload, f.faults.error_code)


@compilable
def _is_good(s: Feedback, checked: CheckState, payload: int, length: float, data_id: float) -> bool:
    status = check(TOLERANCES, checked, payload, int(length), int(data_id))
    if is_valid(status):
        s.lost += checked.lost_data
        return True
    if status in (WRONG_CRC, REPEATED, WRONG_SEQUENCE):
        s.refused += 1.0
    return False


@compilable
def end_cycle(s: Feedback) -> None:
    """Tell the check of the fastest frame when none has come since the last call."""
    if s.heard == 0.0:
        no_new_data(s.motion)
    s.heard = 0.0
