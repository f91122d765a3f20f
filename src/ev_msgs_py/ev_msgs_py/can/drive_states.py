"""The states of a drive by CiA 402 (IEC 61800-7-201): statusword, controlword and transitions.

Numbers of states are ours; numbers in brackets are those of the transitions in the standard's
figure.
"""

from ev_msgs_py.compilable import compilable

STATE_NAMES = (
    "not ready to switch on",
    "switch on disabled",
    "ready to switch on",
    "switched on",
    "operation enabled",
    "quick stop active",
    "fault reaction active",
    "fault",
)
(
    NOT_READY,
    SWITCH_ON_DISABLED,
    READY_TO_SWITCH_ON,
    SWITCHED_ON,
    OPERATION_ENABLED,
    QUICK_STOP_ACTIVE,
    FAULT_REACTION_ACTIVE,
    FAULT,
) = range(len(STATE_NAMES))

# Statusword (6041h)
STATE_BITS = (0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08)  # bits 0 to 3, 5 and 6
_STATE_MASK = 0x6F
VOLTAGE_ENABLED = 0x10
WARNING = 0x80
REMOTE = 0x200
TARGET_REACHED = 0x400
INTERNAL_LIMIT = 0x800

# Controlword (6040h)
SWITCH_ON = 0x01
ENABLE_VOLTAGE = 0x02
NO_QUICK_STOP = 0x04
ENABLE_OPERATION = 0x08
FAULT_RESET = 0x80
DISABLE_VOLTAGE = 0x00
QUICK_STOP = ENABLE_VOLTAGE
SHUTDOWN = ENABLE_VOLTAGE | NO_QUICK_STOP
SWITCH_ON_COMMAND = SHUTDOWN | SWITCH_ON
ENABLE_COMMAND = SWITCH_ON_COMMAND | ENABLE_OPERATION


@compilable
def state_of(statusword: int) -> int:
    """The state in a statusword; NOT_READY for bits that no state has."""
    bits = statusword & _STATE_MASK
    if bits & 0x4F == 0x40:
        return SWITCH_ON_DISABLED  # bit 5 has no meaning here
    if bits & 0x4F == 0x08:
        return FAULT
    if bits & 0x4F == 0x0F:
        return FAULT_REACTION_ACTIVE
    for state in range(READY_TO_SWITCH_ON, QUICK_STOP_ACTIVE + 1):
        if bits == STATE_BITS[state]:
            return state
    return NOT_READY


@compilable
def next_state(
    state: int, control: int, reset: bool, faulty: bool, charged: bool, torque_gone: bool
) -> int:
    """The state after one look at the controlword.

    `reset`: its bit 7 has just risen; `faulty`: there is a cause of a fault; `charged`: the DC link
    is; `torque_gone`: the motor has no torque.
    """
    if state == FAULT:
        return SWITCH_ON_DISABLED if reset and not faulty else FAULT  # (15)
    if state == FAULT_REACTION_ACTIVE:
        return FAULT if torque_gone else FAULT_REACTION_ACTIVE  # (14)
    if faulty:
        return FAULT_REACTION_ACTIVE  # (13)
    if state == NOT_READY:
        return SWITCH_ON_DISABLED  # (1)
    if control & ENABLE_VOLTAGE == 0:
        return SWITCH_ON_DISABLED  # (7), (9), (10), (12)
    if state == QUICK_STOP_ACTIVE:
        return SWITCH_ON_DISABLED if torque_gone else QUICK_STOP_ACTIVE  # (12)
    if control & NO_QUICK_STOP == 0:
        return (
            QUICK_STOP_ACTIVE if state == OPERATION_ENABLED else SWITCH_ON_DISABLED
        )  # (11), (7), (10)
    return _next_enabled(state, control, charged)


@compilable
def _next_enabled(state: int, control: int, charged: bool) -> int:
    if state == SWITCH_ON_DISABLED:
        return (
            READY_TO_SWITCH_ON if control & SWITCH_ON == 0 else SWITCH_ON_DISABLED
        )  # (2): shutdown
    if control & SWITCH_ON == 0:
        return READY_TO_SWITCH_ON  # (6), (8)
    if state == READY_TO_SWITCH_ON:
        return SWITCHED_ON if charged else READY_TO_SWITCH_ON  # (3)
    return OPERATION_ENABLED if control & ENABLE_OPERATION != 0 else SWITCHED_ON  # (4), (5)


@compilable
def controlword_towards_operation(state: int) -> int:
    """The controlword that leads a drive one state nearer to operation enabled."""
    if state == SWITCH_ON_DISABLED:
        return SHUTDOWN
    if state == READY_TO_SWITCH_ON:
        return SWITCH_ON_COMMAND
    if state in (SWITCHED_ON, OPERATION_ENABLED):
        return ENABLE_COMMAND
    return DISABLE_VOLTAGE
