"""Coolant loop of the battery on the bench (dissertation, section 4.2 and figure 4.8)."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import ev_stack
from ev_bench.machines.battery_loop import (
    BatteryLoopParameters,
    BatteryLoopState,
    advance_battery,
    coolant_of_battery,
)
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.files import vehicle_of

WATER = 3.5e3 * 1.06 / 60.0  # W of 1 l/min and 1 K: with glycol, 3.5 kJ/(kg K) and 1.06 kg/l
VEHICLE = vehicle_of("dissertation_class_b")
CAR = namespace(number_tree(VEHICLE))
BATTERY = VEHICLE.battery
P = BatteryLoopParameters()
AIR = BATTERY.cells.ambient


def driven(current, duration, p=P, cooling=1.0, period=10.0, begun=None):
    """State after a steady current."""
    s = dataclasses.replace(begun or BatteryLoopState())
    for _ in range(round(duration / period)):
        advance_battery(p, CAR, s, cooling, current, period)
    return s


@given(st.floats(-300.0, 300.0), st.floats(1.0, 30.0), st.floats(0.1, 10.0))
def test_heat_of_the_battery_leaves_by_coolant_and_air(current, flow, resistance):
    """R I^2 = flow c rho (T_out - T_in) + n (T - T_air)/R in the end, whatever the numbers."""
    p = BatteryLoopParameters(flow=flow, cell_resistance=resistance, fan_on=99.0)
    s = driven(current, 1e5, p, period=1e3)
    flowing, cold, warm = coolant_of_battery(p, CAR, s, 1.0)
    by_air = BATTERY.cells.in_series * s.rise / BATTERY.cells.thermal_resistance
    by_coolant = flowing * WATER * (warm - cold)
    loss = BATTERY.resistance * current**2
    # Differences of temperatures of about 25 degC: their rounding, times the flow.
    assert by_coolant + by_air == pytest.approx(loss, rel=1e-6, abs=1e-9 * flow)
    assert AIR <= cold <= warm <= AIR + s.rise + 1e-9


def test_much_flow_leaves_cells_and_radiator_in_series():
    """All of the coolant is then equally warm: Q = rise/(R_cell/n + 1/K), within 1 %."""
    p = dataclasses.replace(P, flow=100.0, fan_on=99.0)
    s = driven(200.0, 1e5, p, period=1e3)
    flow, cold, warm = coolant_of_battery(p, CAR, s, 1.0)
    in_series = P.cell_resistance / BATTERY.cells.in_series + 1.0 / P.radiator
    assert flow * WATER * (warm - cold) == pytest.approx(s.rise / in_series, rel=0.01)


def test_a_radiator_without_end_sends_the_coolant_back_as_cold_as_the_air():
    """The coolant leaves by 1 - exp(-n/(R_cell G)) of the rise of the cells, G = c rho flow."""
    p = dataclasses.replace(P, radiator=1e5)
    s = driven(100.0, 1000.0, p)
    flow, cold, warm = coolant_of_battery(p, CAR, s, 1.0)
    assert cold == pytest.approx(AIR, abs=1e-12)
    share = 1.0 - math.exp(-BATTERY.cells.in_series / (P.cell_resistance * flow * WATER))
    assert warm - AIR == pytest.approx(share * s.rise, rel=1e-9)


def test_steps_of_any_width_give_the_same():
    """The equation of the cells is solved exactly while the fan stays as it is."""
    fine = driven(100.0, 600.0, period=1.0)
    assert fine.rise == pytest.approx(driven(100.0, 600.0, period=600.0).rise, rel=1e-12)
    assert fine.rise > 0.1


def test_fan_runs_between_two_temperatures():
    """It starts at 35 degC out of the battery, cools, and goes on until 30 degC."""
    hot = driven(300.0, 20_000.0, dataclasses.replace(P, fan_on=99.0))
    assert coolant_of_battery(P, CAR, hot, 1.0).coolant_out > P.fan_on
    s = driven(0.0, 10.0, begun=hot)
    assert s.fan == 1.0
    seen = []
    while s.fan == 1.0:
        seen.append(coolant_of_battery(P, CAR, s, 1.0).coolant_out)
        s = driven(0.0, 10.0, begun=s)
    assert seen == sorted(seen, reverse=True)
    assert min(seen) < P.fan_off + 0.1
    # Cold coolant does not start it again.
    assert driven(0.0, 1000.0, begun=s).fan == 0.0


def test_without_cooling_the_cells_have_the_air_alone():
    """C T' = R I^2/n - (T - T_air)/R ends at R_air R I^2/n; nothing flows."""
    s = driven(100.0, 1e5, cooling=0.0)
    cells = BATTERY.cells
    alone = cells.thermal_resistance * BATTERY.resistance * 100.0**2 / cells.in_series
    assert s.rise == pytest.approx(alone, rel=1e-6)
    assert tuple(coolant_of_battery(P, CAR, s, 0.0)) == (0.0, AIR + s.rise, AIR + s.rise)
    assert driven(100.0, 1e5).rise < 0.6 * alone


def test_a_fan_that_stops_above_its_start_is_refused():
    with pytest.raises(ParameterError, match="fan_off is 40 degC, expected below fan_on, 35 degC"):
        BatteryLoopParameters(fan_off=40.0)


def test_the_bench_shows_the_loop_beside_those_of_its_machines():
    """Both machines of `bench_load` draw from the battery, whose coolant warms."""
    channels = (
        ev_stack.run(
            "bench_load",
            runs=("constant_speed",),
            method={"test_bench": "circuits_with_flow"},
            duration=60.0,
        )
        .runs["constant_speed"]
        .channels
    )
    rise = (
        channels["bench.battery_coolant.coolant_out"] - channels["bench.battery_coolant.coolant_in"]
    )
    assert (channels["bench.battery_coolant.flow"] == 8.0).all()
    assert rise[0] == 0.0
    assert rise[-1] > rise[1000] > 0.0
