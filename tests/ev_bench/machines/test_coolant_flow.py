"""Flow sensors in the coolant loops of the bench (dissertation, section 4.2)."""

from __future__ import annotations

import numpy as np
import pytest

import ev_stack

WATER = 3.5e3 * 1.06 / 60.0  # W of 1 l/min and 1 K: with glycol, 3.5 kJ/(kg K) and 1.06 kg/l


def driven(**changed):
    """Both machines of each circuit hold 60 N m against each other at 300 and 150 rad/s."""
    values = {name.replace("__", "."): value for name, value in changed.items()}
    method = {"test_bench": values.pop("method", "circuits_with_flow")}
    duration = values.pop("duration", 2.0)
    return ev_stack.run(
        "bench_load", runs=("constant_speed",), method=method, duration=duration, set=values
    )


@pytest.mark.parametrize("flow", [4.0, 8.0])
def test_flow_and_temperatures_show_the_heat_of_a_machine(flow):
    """Flow times the rise of the coolant is the heat of winding and power stage at any flow.

    At 60 N m that is 0.045 M^2 + 2 M = 282 W (the car's file); of the slower winding e^-10 is left
    after 600 s with C R = 4000 J/K 0.015 K/W.
    """
    c = (
        driven(duration=600.0, **{"*.vehicle.motor.thermal.coolant_flow": flow})
        .runs["constant_speed"]
        .channels
    )
    rise = (
        c["bench.temperatures.coolant_out.front_left"]
        - c["bench.temperatures.coolant_in.front_left"]
    )[-1]
    assert c["bench.coolant.flow.front_left"][-1] == flow
    assert flow * WATER * rise == pytest.approx(0.045 * 60.0**2 + 2.0 * 60.0, rel=1e-3)


def test_nothing_flows_without_cooling_nor_where_there_is_no_circuit():
    c = driven(duration=0.1).runs["constant_speed"].channels
    assert c["bench.coolant.load_flow.front_right"][-1] == 8.0
    assert c["bench.coolant.flow.rear_left"][-1] == 0.0
    c = driven(duration=0.1, test_bench__cooling=False).runs["constant_speed"].channels
    assert (
        c["bench.coolant.flow.front_left"][-1] == c["bench.coolant.load_flow.front_left"][-1] == 0.0
    )


def test_the_sensors_change_nothing_else():
    """Published hashes are those of `circuits`; all it writes is the same to the bit."""
    with_flow = driven().runs["constant_speed"].channels
    without = driven(method="circuits").runs["constant_speed"].channels
    assert set(with_flow) - set(without) == {
        name for name in with_flow if name.startswith(("bench.coolant.", "bench.battery_coolant."))
    }
    assert all(np.array_equal(values, with_flow[name]) for name, values in without.items())


def test_a_flow_sensor_errs_as_declared():
    noisy = (
        driven(test_bench__sensors__bench_coolant_flow__bias=0.5).runs["constant_speed"].channels
    )
    assert noisy["bench.coolant.flow.front_left"][-1] == 8.5
    assert noisy["bench.coolant.flow.rear_left"][-1] == 0.0
