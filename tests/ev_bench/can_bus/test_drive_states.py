"""States of a drive by CiA 402."""

from __future__ import annotations

import itertools

import pytest

from ev_core.compiled.loop import compiled
from ev_msgs_py.can.drive_states import (
    DISABLE_VOLTAGE,
    ENABLE_COMMAND,
    FAULT,
    FAULT_REACTION_ACTIVE,
    FAULT_RESET,
    NOT_READY,
    OPERATION_ENABLED,
    QUICK_STOP,
    QUICK_STOP_ACTIVE,
    READY_TO_SWITCH_ON,
    SHUTDOWN,
    STATE_BITS,
    STATE_NAMES,
    SWITCH_ON_COMMAND,
    SWITCH_ON_DISABLED,
    SWITCHED_ON,
    controlword_towards_operation,
    next_state,
    state_of,
)

STATES = range(len(STATE_NAMES))
# CiA 402, table of the statusword: bit patterns xxxx xxxx xBBx BBBB, x stands for anything.
PATTERNS = {
    NOT_READY: "x0xx0000",
    SWITCH_ON_DISABLED: "x1xx0000",
    READY_TO_SWITCH_ON: "x01x0001",
    SWITCHED_ON: "x01x0011",
    OPERATION_ENABLED: "x01x0111",
    QUICK_STOP_ACTIVE: "x00x0111",
    FAULT_REACTION_ACTIVE: "x0xx1111",
    FAULT: "x0xx1000",
}


def after(
    state: int, control: int, reset=False, faulty=False, charged=True, torque_gone=True
) -> int:
    return next_state(state, control, reset, faulty, charged, torque_gone)


@pytest.mark.parametrize("state", STATES)
def test_statuswords_are_those_of_the_standard(state: int):
    pattern = PATTERNS[state]
    for bits in itertools.product("01", repeat=pattern.count("x")):
        filled = iter(bits)
        word = int("".join(next(filled) if p == "x" else p for p in pattern), 2)
        assert state_of(word) == state
    assert state_of(STATE_BITS[state]) == state


# (state, controlword) -> state, with the number of the transition in the standard's figure
TRANSITIONS = {
    1: (NOT_READY, DISABLE_VOLTAGE, SWITCH_ON_DISABLED),
    2: (SWITCH_ON_DISABLED, SHUTDOWN, READY_TO_SWITCH_ON),
    3: (READY_TO_SWITCH_ON, SWITCH_ON_COMMAND, SWITCHED_ON),
    4: (SWITCHED_ON, ENABLE_COMMAND, OPERATION_ENABLED),
    5: (OPERATION_ENABLED, SWITCH_ON_COMMAND, SWITCHED_ON),
    6: (SWITCHED_ON, SHUTDOWN, READY_TO_SWITCH_ON),
    7: (READY_TO_SWITCH_ON, DISABLE_VOLTAGE, SWITCH_ON_DISABLED),
    8: (OPERATION_ENABLED, SHUTDOWN, READY_TO_SWITCH_ON),
    9: (OPERATION_ENABLED, DISABLE_VOLTAGE, SWITCH_ON_DISABLED),
    10: (SWITCHED_ON, QUICK_STOP, SWITCH_ON_DISABLED),
    11: (OPERATION_ENABLED, QUICK_STOP, QUICK_STOP_ACTIVE),
    12: (QUICK_STOP_ACTIVE, QUICK_STOP, SWITCH_ON_DISABLED),
    14: (FAULT_REACTION_ACTIVE, ENABLE_COMMAND, FAULT),
}


@pytest.mark.parametrize("number", TRANSITIONS)
def test_transitions_of_the_standard(number: int):
    state, control, then = TRANSITIONS[number]
    assert after(state, control) == then


@pytest.mark.parametrize("state", set(STATES) - {FAULT, FAULT_REACTION_ACTIVE})
def test_a_fault_is_reacted_to_in_every_state(state: int):
    """Transition 13."""
    for control in range(256):
        assert after(state, control, faulty=True) == FAULT_REACTION_ACTIVE


def test_nothing_but_a_reset_without_a_cause_leads_out_of_a_fault():
    """Transition 15."""
    for control, reset, faulty in itertools.product(range(256), (False, True), (False, True)):
        expected = SWITCH_ON_DISABLED if reset and not faulty else FAULT
        assert after(FAULT, control, reset=reset, faulty=faulty) == expected


def test_operation_is_enabled_by_no_single_controlword():
    """Two steps at least lie before torque, whatever a broken controller repeats."""
    for control in range(256):
        state = SWITCH_ON_DISABLED
        for _ in range(10):
            state = after(state, control, reset=bool(control & FAULT_RESET))
        assert state != OPERATION_ENABLED


def test_it_is_not_switched_on_before_the_dc_link_is_charged():
    assert after(READY_TO_SWITCH_ON, SWITCH_ON_COMMAND, charged=False) == READY_TO_SWITCH_ON


def test_a_quick_stop_lasts_until_the_torque_is_gone():
    assert after(QUICK_STOP_ACTIVE, ENABLE_COMMAND, torque_gone=False) == QUICK_STOP_ACTIVE


def test_the_controlwords_of_the_gateway_lead_to_operation():
    state, passed = NOT_READY, []
    for _ in range(5):
        state = after(state, controlword_towards_operation(state))
        passed.append(state)
    assert passed == [
        SWITCH_ON_DISABLED,
        READY_TO_SWITCH_ON,
        SWITCHED_ON,
        OPERATION_ENABLED,
        OPERATION_ENABLED,
    ]
    assert controlword_towards_operation(FAULT) == DISABLE_VOLTAGE


def test_compiled_code_goes_the_same_ways():
    step, read = compiled(next_state), compiled(state_of)
    flags = list(itertools.product((False, True), repeat=4))
    for state, control in itertools.product(
        STATES, (0x00, 0x02, 0x06, 0x07, 0x0B, 0x0F, 0x80, 0x8F)
    ):
        for given in flags:
            assert step(state, control, *given) == next_state(state, control, *given)
    assert [read(word) for word in range(256)] == [state_of(word) for word in range(256)]
