"""The free symmetric differential."""

from __future__ import annotations

import pytest
from helpers.differentials import DISSERTATION, Differential, Motion, on

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels


def test_no_wheel_gets_more_than_its_motor_has():
    """360 N m x 7.4 = 2664 N m, and the other wheel gets no more."""
    law = Differential("open_differential", DISSERTATION)
    assert law.step(Motion(torque=9000.0)).drive == Wheels.front(2664.0, 2664.0)
    assert law.step(Motion(torque=-9000.0)).drive == Wheels.front(-2664.0, -2664.0)


@pytest.mark.parametrize("torque", [1000.0, -1000.0, 0.1])
def test_below_that_all_of_the_torque_is_shared_equally(torque):
    four = Differential("open_differential", on(DISSERTATION, WHEEL_NAMES))
    assert (
        Differential("open_differential", DISSERTATION).step(Motion(torque=torque)).drive[:2]
        == (torque / 2,) * 2
    )
    assert four.step(Motion(torque=torque)).drive == (torque / 4,) * 4
