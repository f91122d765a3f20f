"""The battery behind one resistance."""

from __future__ import annotations

import pytest

from ev_sim.drives.electrical_side import current_at_power, open_circuit_voltage


def test_battery_current_and_voltage():
    table = (400.0, 420.0, 440.0)
    assert open_circuit_voltage(table, 0.25) == pytest.approx(410.0)
    current = current_at_power(420.0, 0.1, 40e3)
    assert (420.0 - 0.1 * current) * current == pytest.approx(40e3)
    assert current_at_power(420.0, 0.1, -20e3) < 0.0
