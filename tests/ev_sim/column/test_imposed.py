"""A road-wheel angle over time, imposed on the car."""

from __future__ import annotations

import pytest
from column.columns import CAR, Column


def test_the_angle_follows_its_profile_as_the_sensor_is_corrected():
    """The angle is scale * given(t - delay) + offset at every instant.

    The rate leads to the next one.
    """
    changed = {"time": (0.0, 1.0), "angle": (0.0, 0.1), "scale": 1.1, "offset": 0.01, "delay": 0.05}
    column = Column("imposed", 0.01, **changed)
    before = column.advance(3.0)
    for n in range(2, 80):
        state = column.advance(3.0)
        assert state.road_wheel_angle == pytest.approx(
            1.1 * max(0.1 * (n * 0.01 - 0.05), 0.0) + 0.01, abs=1e-12
        )
        assert before.road_wheel_angle + 0.01 * before.road_wheel_rate == pytest.approx(
            state.road_wheel_angle, abs=1e-12
        )
        assert state.angle == CAR.steering_ratio * state.road_wheel_angle
        before = state
