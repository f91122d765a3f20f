"""Traction control by the last torque in the range (dissertation, section 2.4, principle 3)."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.traction import Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels


def test_torque_of_the_last_step_in_the_range_is_the_limit_beyond_it():
    """Eqs 1.5, 1.6: at S = 0.18 1200 N m pass.

    At 0.25 and 0.3 they are the limit; back at 0.17 nothing is limited.

    The slip begins at 0.1: "must reach the set value", so below the range nothing is limited
    either.
    """
    law = Control("held_torque")
    passed = []
    for slip, asked in (
        (0.1, 1000.0),
        (0.18, 1200.0),
        (0.25, 1400.0),
        (0.3, 1500.0),
        (0.17, 1500.0),
    ):
        m = spinning_at(10.0 / (1.0 - slip), 10.0)
        passed.append(law.step(dataclasses.replace(m, drive=Wheels.front(asked, asked))))
    assert [wheels.front_left for wheels in passed] == [1000.0, 1200.0, 1200.0, 1200.0, 1500.0]
    # it rolls
    assert [wheels.front_right for wheels in passed] == [1000.0, 1200.0, 1400.0, 1500.0, 1500.0]


@pytest.mark.slow
def test_a_torque_that_spins_a_wheel_keeps_it_spinning():
    """The range lies behind the peak at 0.09 of packed snow.

    The slip is that without control within 5 %.
    """
    from helpers.launches import full_throttle, slip_of

    with_law, off = (
        slip_of(full_throttle(name, "packed_snow_1"))[200:].mean()
        for name in ("held_torque", "off")
    )
    assert 0.95 * off < with_law <= off
