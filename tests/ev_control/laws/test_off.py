"""No traction control at all."""

from __future__ import annotations

import math

from helpers.traction import Control, any_wheels
from hypothesis import given

from ev_msgs_py.contract.signals import WheelTorqueRequest
from ev_msgs_py.contract.wheels import Wheels


@given(drive=any_wheels, brake=any_wheels)
def test_everything_passes_to_the_bit(drive, brake):
    command = Control("off").law.step(WheelTorqueRequest(drive, brake))
    assert (command.drive, command.brake) == (drive, brake)


def test_what_is_no_number_passes_as_well():
    """It is not for this law to hide what its neighbour says."""
    assert math.isnan(
        Control("off").law.step(WheelTorqueRequest(Wheels.all(math.nan))).drive.rear_left
    )
