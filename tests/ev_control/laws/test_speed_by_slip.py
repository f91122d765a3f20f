"""Speed set-points by the slip (dissertation, section 2.4, principle 2)."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.traction import FASTEST, PERIOD, SPINNING, Control, Measured

from ev_msgs_py.contract.wheels import Wheels


def at_slip(slip: float) -> Measured:
    """Both front wheels at this slip, over a car that rolls at 20 rad/s."""
    return dataclasses.replace(
        SPINNING, speed=Wheels(20.0 / (1.0 - slip), 20.0 / (1.0 - slip), 20.0, 20.0)
    )


def test_slip_beyond_the_range_lowers_the_set_point_and_slip_below_raises_it():
    """Principle 2, from the speed of the wheel on.

    1 rad/s in each step of 5 ms down, 0.3 up, none inside the range.
    """
    law = Control("speed_by_slip")
    slips = (0.16, 0.25, 0.25, 0.17, 0.1, 0.1)
    speeds = [law.set_points(at_slip(slip)).front_left for slip in slips]
    first = 20.0 / 0.75 - 200.0 * PERIOD
    rise = 60.0 * PERIOD
    expected = [
        FASTEST,
        first,
        first - 1.0,
        first - 1.0,
        first - 1.0 + rise,
        first - 1.0 + 2 * rise,
    ]
    assert speeds == pytest.approx(expected, rel=1e-12)


def test_set_point_ends_when_the_drive_has_given_the_request_for_a_while():
    """It does for 0.2 s; a torque below 95 % of it begins the time again."""
    law = Control("speed_by_slip")
    law.set_points(at_slip(0.25))
    gives, lacks = (
        at_slip(0.1),
        dataclasses.replace(at_slip(0.1), torque=Wheels.front(1400.0, 1400.0)),
    )
    for m in [*[gives] * 30, lacks, *[gives] * 39]:
        assert law.set_points(m).front_left < FASTEST
    assert [law.set_points(gives).front_left for _ in range(3)][-1] == FASTEST
