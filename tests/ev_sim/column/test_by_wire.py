"""The steering wheel without mechanical connection."""

from __future__ import annotations

import pytest
from column.columns import Column


def test_steering_wheel_by_wire_settles_at_the_centring_spring():
    """M_b/k = 1/0.25 = 4 rad; after 20 s the free motion has decayed to e^-40."""
    column = Column("by_wire")
    for _ in range(20000):
        state = column.advance(1.0)
    assert state.angle == pytest.approx(4.0, rel=1e-9)
