"""Cells in series: relaxation, limits of the current by temperature."""

from __future__ import annotations

import math

import pytest

from ev_core.parameters.values import build
from ev_core.vehicle.battery import Battery, Cells
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.electrical_side import (
    cell_power_limits,
    current_at_power,
    relaxed,
    temperature_share,
)

CORNERS = (0.0, 10.0, 45.0, 60.0)


def test_relaxation_is_the_exponential():
    """100 A for two time constants in 1000 steps, then as long at rest: exact but for rounding."""
    tau, steps, resistance = 30.0, 1000, 0.103
    share = -math.expm1(-2.0 * tau / steps / tau)
    voltage = 0.0
    for current, expected in (
        (100.0, 10.3 * (1 - math.exp(-2.0))),
        (0.0, 10.3 * (1 - math.exp(-2.0)) * math.exp(-2)),
    ):
        for _ in range(steps):
            voltage = relaxed(voltage, current, resistance, share)
        assert voltage == pytest.approx(expected, rel=1e-11)


def test_currents_by_temperature():
    places = {
        -5.0: 0.0,
        0.0: 0.0,
        5.0: 0.5,
        10.0: 1.0,
        30.0: 1.0,
        45.0: 1.0,
        51.0: 0.6,
        60.0: 0.0,
        80.0: 0.0,
    }
    for temperature, share in places.items():
        assert temperature_share(CORNERS, temperature) == pytest.approx(share)


def test_the_limits_of_power_are_those_of_current():
    """The power that may be given or taken is that at the largest current, times its share."""
    battery = Battery(discharge_power=1e7, charge_power=1e7)
    give, take = cell_power_limits(battery, 660.0, 0.2, 0.5, 1.0, 0.5)
    assert current_at_power(660.0, 0.2, give) == pytest.approx(490.0)
    assert current_at_power(660.0, 0.2, -take) == pytest.approx(-90.0)
    assert cell_power_limits(battery, 660.0, 0.2, 0.0, 1.0, 1.0)[0] == 0.0
    assert cell_power_limits(battery, 660.0, 0.2, 1.0, 1.0, 1.0)[1] == 0.0
    weak = cell_power_limits(battery, 66.0, 0.2, 0.5, 1.0, 1.0)[0]
    assert weak == pytest.approx(66.0**2 / (4.0 * 0.2)), "no current gives more"


@pytest.mark.parametrize(
    "wrong",
    [
        {"resistance": math.nan},
        {"open_circuit_voltage": (3.2, math.nan)},
        {"open_circuit_voltage": (3.2,)},
        {"charge_temperature": (0.0, 10.0, 60.0)},
        {"charge_temperature": (10.0, 0.0, 45.0, 60.0)},
    ],
)
def test_senseless_cells_are_refused(wrong):
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        build(Cells, wrong)
