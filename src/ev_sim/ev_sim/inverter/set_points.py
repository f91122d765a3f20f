"""Set-points from the bus: judged, taken over, and watched while none comes."""

from __future__ import annotations

from ev_core.bus.checking import (
    OK_SOME_LOST,
    REPEATED,
    TOLERANCES,
    WRONG_CRC,
    WRONG_SEQUENCE,
    check,
    is_valid,
    no_new_data,
)
from ev_msgs_py.can.drive_states import ENABLE_OPERATION, FAULT_RESET
from ev_msgs_py.can.frames import COMMAND_TIMEOUT, RPM, WRONG_COUNTER, WRONG_CRC_FAULT, DeviceFrames, SetPointLayout
from ev_msgs_py.can.payload import extracted
from ev_msgs_py.compilable import compilable
from ev_sim.inverter.state import Inverter


@compilable
def receive_set_point(layout: SetPointLayout, own: DeviceFrames, s: Inverter, payload: int) -> int:
    """Judge a set-point frame, and take its content over if it is valid; the status of the check."""
    s.supervision.heard = 1.0
    status = check(TOLERANCES, s.check, payload, int(layout.length), int(own.set_point_data_id))
    if is_valid(status):
        _take_over(layout, s, payload)
        s.supervision.age = s.supervision.wrong_crc = s.supervision.wrong_counter = 0.0
        if status == OK_SOME_LOST:
            s.supervision.lost_age = 0.0
        return status
    if status == WRONG_CRC:
        s.supervision.wrong_crc += 1.0
        s.supervision.refused_age = 0.0
    elif status in (REPEATED, WRONG_SEQUENCE):
        s.supervision.wrong_counter += 1.0
        s.supervision.refused_age = 0.0
    return status


@compilable
def _take_over(layout: SetPointLayout, s: Inverter, payload: int) -> None:
    """A reset counts where its bit rises, without a torque set-point and with operation disabled."""
    before = int(s.command.controlword)
    control = int(extracted(payload, layout.controlword))
    torque = extracted(payload, layout.torque)
    risen = control & FAULT_RESET != 0 and before & FAULT_RESET == 0
    if risen and torque == 0.0 and control & ENABLE_OPERATION == 0:
        s.command.reset = 1.0
    s.command.controlword = float(control)
    s.command.mode = extracted(payload, layout.mode)
    s.command.direction = extracted(payload, layout.direction)
    s.command.torque = torque
    s.command.speed = RPM * extracted(payload, layout.speed)
    s.command.torque_limit = extracted(payload, layout.torque_limit)


@compilable
def begin_cycle(s: Inverter) -> None:
    """Tell the check when no frame has come since the last cycle."""
    if s.supervision.heard == 0.0:
        no_new_data(s.check)
    s.supervision.heard = 0.0


@compilable
def end_cycle(s: Inverter, period: float) -> None:
    """What has come gets older by one cycle [s]."""
    grow_older(s, period)
    s.command.reset = 0.0


@compilable
def grow_older(s: Inverter, duration: float) -> None:
    """Time [s] has passed without a cycle, as in a process that was held up."""
    s.supervision.age += duration
    s.supervision.refused_age += duration
    s.supervision.lost_age += duration


@compilable
def missing_set_point(s: Inverter, timeout: float, period: float) -> int:
    """The bit of the fault that names why there has been no valid set-point for `timeout` [s]; 0 if there has been.

    To half a period, so that it does not hang on how the age was rounded.
    """
    if s.supervision.age < timeout - 0.5 * period:
        return 0
    if s.supervision.wrong_crc > 0.0:
        return WRONG_CRC_FAULT
    return WRONG_COUNTER if s.supervision.wrong_counter > 0.0 else COMMAND_TIMEOUT
