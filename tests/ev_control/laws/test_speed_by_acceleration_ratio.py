"""Speed set-points by the ratio of accelerations (dissertation, section 2.4, principle 1)."""

from __future__ import annotations

import pytest
from helpers.traction import PERIOD, Control, spinning_at


def test_ratio_of_accelerations_lowers_the_set_point():
    """Principle 1: a_x/w' = 1/100 m is far below the threshold of 0.16 m, 1/5 m above it.

    Then the set-point rises.
    """
    law = Control(
        "speed_by_acceleration_ratio",
        **{f"criterion.{name}": 0.0 for name in ("filter_time", "grip_slip", "least_gain")},
    )
    law.set_points(spinning_at(12.0, 10.0))
    lowered = law.set_points(spinning_at(12.0 + 100.0 * PERIOD, 10.0)).front_left
    assert lowered == pytest.approx(12.5 - 200.0 * PERIOD, rel=1e-12)
    raised = law.set_points(spinning_at(12.5 + 5.0 * PERIOD, 10.0)).front_left
    assert raised == pytest.approx(lowered + 60.0 * PERIOD, rel=1e-12)
