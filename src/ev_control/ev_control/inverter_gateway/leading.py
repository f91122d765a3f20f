"""Leading an inverter through its states: enable, stop at the first fault, reset in sequence."""

from __future__ import annotations

from ev_control.inverter_gateway.hearing import end_cycle
from ev_control.inverter_gateway.parameters import BOTH, GatewayParameters
from ev_control.inverter_gateway.state import Device, Gateway
from ev_msgs_py.can.drive_states import (
    DISABLE_VOLTAGE,
    FAULT,
    FAULT_REACTION_ACTIVE,
    FAULT_RESET,
    OPERATION_ENABLED,
    SWITCH_ON_DISABLED,
    controlword_towards_operation,
)
from ev_msgs_py.can.frames import TORQUE_MODE
from ev_msgs_py.compilable import compilable

_QUIET = 0.005  # s without torque, command or reset bit, with which a reset begins: its bit shall be seen to rise
_ALONE = 10.0  # cycles in which the other drive could have said that it is released, too
MAY_BE_ENABLED, LATCHED, SILENT, WITHOUT_COMMAND, DOUBTFUL = range(5)


@compilable
def advance_gateway(p: GatewayParameters, s: Gateway, ticks: float, period: float) -> None:
    """Lead all devices over some ticks, `period` [s] in all, after the frames of this cycle."""
    if s.waits != 0.0:
        _enable_where_possible(p, s)
    _advance(p, s.drive_11, period)
    _advance(p, s.drive_12, period)
    _advance(p, s.load_11, period)
    _advance(p, s.load_12, period)
    if p.fault_stops == BOTH and (is_faulty(s.drive_11) or is_faulty(s.drive_12)):
        s.drive_11.enable = s.drive_12.enable = 0.0
    s.tick += ticks


@compilable
def _enable_where_possible(p: GatewayParameters, s: Gateway) -> None:
    """The load machines first: until they hold the shafts as they are told, the drives' measurements are in doubt.

    Then both drives together, or the one of them that says that it follows its controlword.
    """
    if refusal(p, s.load_11) == MAY_BE_ENABLED:
        s.load_11.enable = 1.0
    if refusal(p, s.load_12) == MAY_BE_ENABLED:
        s.load_12.enable = 1.0
    right, left = s.drive_11.feedback.remote, s.drive_12.feedback.remote
    s.waits = s.waits + 1.0 if right != left else 1.0
    right_ready = right < left or refusal(p, s.drive_11) == MAY_BE_ENABLED
    left_ready = left < right or refusal(p, s.drive_12) == MAY_BE_ENABLED
    if right_ready and left_ready and (right == left or s.waits > _ALONE):
        s.drive_11.enable = 1.0 if right >= left else 0.0
        s.drive_12.enable = 1.0 if left >= right else 0.0
        s.waits = 0.0


@compilable
def _advance(p: GatewayParameters, s: Device, period: float) -> None:
    end_cycle(s.feedback)
    advance_device(p, s, period)


@compilable
def advance_device(p: GatewayParameters, s: Device, period: float) -> None:
    """Note what is wrong and how a reset goes on, after the frames of this cycle; everything gets older by `period`."""
    state = int(s.feedback.state)
    if s.reset_time >= 0.0:
        _advance_reset(p, s, state, period)
    elif s.enable != 0.0:
        if s.feedback.age >= p.feedback_timeout - 0.5 * period:  # not to hang on how the age was rounded
            s.stale = 1.0
        elif state in (FAULT, FAULT_REACTION_ACTIVE):
            s.tripped = 1.0
        if s.command_age >= p.command_timeout - 0.5 * period:
            s.command_stale = 1.0
        if is_faulty(s):
            s.enable = 0.0
    s.feedback.age += period
    s.command_age += period


@compilable
def is_faulty(s: Device) -> bool:
    """Whether a fault is latched here; only a reset clears it."""
    return s.tripped != 0.0 or s.stale != 0.0 or s.command_stale != 0.0 or s.implausible != 0.0


@compilable
def _advance_reset(p: GatewayParameters, s: Device, state: int, period: float) -> None:
    """It has succeeded when the inverter says, freshly and after the bit was sent, that it is without fault."""
    fresh = s.feedback.age <= p.feedback_timeout
    s.reset_time += period
    if s.reset_time > 2.0 * _QUIET and fresh and state == SWITCH_ON_DISABLED:
        s.tripped = s.stale = s.command_stale = s.implausible = s.doubtful_time = 0.0
        s.reset_time = -1.0
    elif s.reset_time > p.reset_timeout:
        s.reset_time = -1.0


@compilable
def refusal(p: GatewayParameters, s: Device) -> int:
    """Why a device may not be enabled now."""
    if is_faulty(s):
        return LATCHED
    if s.feedback.age > p.feedback_timeout:
        return SILENT
    if s.doubtful_time > 0.0:
        return DOUBTFUL
    return MAY_BE_ENABLED if s.command_age <= p.command_timeout else WITHOUT_COMMAND


@compilable
def begin_reset(s: Device) -> None:
    """Begin the reset sequence: nothing is enabled, then the reset bit."""
    s.enable = 0.0
    s.reset_time = 0.0


@compilable
def controlword(s: Device) -> int:
    """The controlword of the next set-point."""
    if s.reset_time >= 0.0:
        return FAULT_RESET if s.reset_time > _QUIET else DISABLE_VOLTAGE
    return controlword_towards_operation(int(s.feedback.state)) if s.enable != 0.0 else DISABLE_VOLTAGE


@compilable
def may_turn(s: Device) -> bool:
    """Whether its command may go out: it is enabled, and says so."""
    return s.enable != 0.0 and int(s.feedback.state) == OPERATION_ENABLED


@compilable
def command_device(p: GatewayParameters, s: Device, mode: int, value: float) -> None:
    """What a device shall do: a torque [N m] or a speed [rad/s] at its shaft."""
    s.mode, s.command_age = float(mode), 0.0
    if mode == TORQUE_MODE:
        s.torque, s.speed = value, p.speed_limit
    else:
        s.torque, s.speed = 0.0, value
