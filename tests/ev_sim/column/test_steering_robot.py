"""The steering robot turns the steering wheel as standard manoeuvres want it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import Instant

PERIOD = 0.01


def robot_with(values: dict[str, Any], period: float) -> Any:
    method = find_method("steering_column", "steering_robot")
    return create(method, build(method.parameters, values), Vehicle(), period)


def test_robot_angle_goes_on_at_its_rate_without_jumps():
    values = {"profile.time": [0.1, 0.2], "profile.angle": [0.0, 5.0], "max_rate": 10.0}
    robot = robot_with(values, PERIOD)
    (before,) = robot.outputs()
    for n in range(100):
        robot.advance(Instant(n * PERIOD))
        (column,) = robot.outputs()
        assert column.angle == pytest.approx(before.angle + before.rate * PERIOD, abs=1e-12)
        assert abs(column.rate) <= 10.0 + 1e-9
        before = column
    assert column.angle == pytest.approx(5.0)


def test_sine_with_dwell_shape():
    """0.7 Hz: peaks at 0.357 s and from 1.071 s for half a second, zero after 1.929 s."""
    values = {
        "shape": "sine_with_dwell",
        "sine_with_dwell.begin": 0.0,
        "sine_with_dwell.amplitude": 2.0,
    }
    robot = robot_with(values, 1e-3)
    angles = []
    for n in range(2500):
        angles.append(robot.outputs()[0].angle)
        robot.advance(Instant(n * 1e-3))
    assert np.argmax(angles) == pytest.approx(357, abs=1)
    assert max(angles) == pytest.approx(2.0, rel=1e-5)
    held = [n for n, angle in enumerate(angles) if angle == pytest.approx(-2.0, rel=1e-5)]
    assert (held[0], held[-1]) == (pytest.approx(1071, abs=3), pytest.approx(1571, abs=3))
    assert angles[1925] < 0.0 == angles[1930]
