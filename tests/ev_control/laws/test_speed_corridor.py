"""Wheel speeds in a corridor by set-points (dissertation, section 1.4)."""

from __future__ import annotations

import pytest
from helpers.traction import FASTEST, Control, spinning_at

from ev_msgs_py.contract.wheels import Wheels

CORRIDORS = [
    ("road", 0.05, 0.15),
    ("sport", 0.1, 0.22),
    ("winter", 0.03, 0.1),
    ("terrain", 0.2, 0.4),
]


@pytest.mark.parametrize(("regime", "low", "high"), CORRIDORS)
def test_corridor_of_the_regime_decides(regime, low, high):
    """Speeds over rolling just above, inside and just below the corridor.

    The set-point falls, stays, rises.
    """
    law, speeds = Control("speed_corridor", regime=regime), []
    for share in (high + 0.01, high + 0.01, (low + high) / 2.0, low - 0.01):
        m = spinning_at(10.0 * (1.0 + share), 10.0)
        speeds.append(law.set_points(m).front_left)
    assert speeds[0] >= speeds[1] == speeds[2] < speeds[3] < FASTEST


def test_reverse_has_its_own_corridor():
    """0.12 over rolling is inside the corridor of the regime road, and above that of reverse."""
    m = spinning_at(11.2, 10.0)
    assert Control("speed_corridor").set_points(m) == Wheels.all(FASTEST)
    law = Control("speed_corridor")
    law.set_points(m.reversed())
    assert law.set_points(m.reversed()).front_left > -12.0
