"""The torque that ideal, averaged and switched drives give."""

import math

import numpy as np
import pytest
from drives.bench import (
    BUS_VOLTAGE,
    CONTROLS,
    INDUCTANCE,
    RESISTANCE,
    SWITCHED,
    TORQUE_CONSTANT,
    advance_drive,
    drive_with,
    name_of,
    run,
)
from hypothesis import given
from hypothesis import strategies as st

from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.brushless_motor import SECTOR
from ev_sim.drives.drive import DRIVE_MODELS, DriveParameters


@pytest.mark.parametrize("drive", DRIVE_MODELS)
def test_torque_reference_is_limited_to_the_torque_limit(drive):
    """2 % is more than the hysteresis band of 0.5 A in 25 A adds to the mean over 1 ms."""
    for sign in (1.0, -1.0):
        result = run(
            {"drive": drive, "motor.torque_limit": 100.0}, sign * 300.0, 0.0, duration=0.05
        )
        assert result.mean_torque[-1] == pytest.approx(sign * 100.0, rel=0.02)


@given(st.floats(-400, 400), st.floats(-100, 100))
def test_ideal_drive_gives_the_reference_without_losses(torque, speed):
    result = run({"drive": "ideal"}, torque, speed, duration=1e-3)
    assert result.torque[0] == result.mean_torque[0] == torque
    assert result.electrical_power[0] == torque * speed
    assert result.current[0] * TORQUE_CONSTANT == pytest.approx(torque)


def test_averaged_current_follows_the_first_order_loop_it_is_tuned_for():
    """Zero of the controller on the pole of the motor: 1 - exp(-bandwidth t).

    2 %: sampling every 10 us delays a loop of 3000 rad/s by half a sample, 1.5 % of a time
    constant.
    """
    changes = {"drive": "averaged", "averaged.sampling_period": 1e-5}
    result = run(changes, 10.0, 0.0, duration=1e-3, step=1e-5)
    time = 1e-5 * np.arange(1, 101)
    assert result.torque == pytest.approx(10.0 * (1 - np.exp(-3000 * time)), abs=0.02 * 10.0)


def test_averaged_drive_rises_no_faster_than_the_bus_voltage_allows_and_does_not_overshoot():
    """2 L i' = U - 2 R i while the voltage is limited.

    Anti-windup keeps the overshoot below 0.1 %.
    """
    result = run({"drive": "averaged"}, 200.0, 0.0, duration=5e-3, step=1e-4)
    decay = RESISTANCE / INDUCTANCE
    rise = BUS_VOLTAGE / (2 * RESISTANCE) * (1 - math.exp(-decay * 1e-3))
    # midpoint rule at 100 us: (decay h)^2/12 = 3e-7
    assert result.current[9] == pytest.approx(rise, rel=1e-6)
    assert max(result.current) < 1.001 * 200.0 / TORQUE_CONSTANT


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@pytest.mark.parametrize("torque", [12.0, -12.0])
@pytest.mark.parametrize("speed", [-60.0, -5.0, 0.0, 5.0, 60.0])
def test_mean_torque_is_the_reference_in_all_four_quadrants(changes, torque, speed):
    """12 N m drives the car at constant speed; 60 rad/s are 24 km/h.

    1 %: during a commutation the torque dips by the part of the current that is still in the
    outgoing phase.
    """
    result = run(changes, torque, speed, duration=0.4, settled=0.1)
    assert np.mean(result.mean_torque) == pytest.approx(torque, rel=0.01)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
@pytest.mark.parametrize("sector", range(6))
def test_switched_drive_holds_its_torque_at_standstill_in_every_sector_and_on_every_edge(
    changes, sector
):
    """0.5 %: means over 1 ms hold about 15 chopping periods of which one may be cut."""
    for sector_angle in (0.0, 0.7, SECTOR):
        state, parameters = drive_with(changes)
        state["sector"], state["sector_angle"] = sector, sector_angle
        torques = []
        for _ in range(50):
            advance_drive(state, parameters, -20.0, 0.0, BUS_VOLTAGE, 1e-3)
            torques.append(state["mean_torque"])
        assert np.mean(torques[10:]) == pytest.approx(-20.0, rel=0.005)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_switched_drive_keeps_its_torque_while_the_rotor_swings_to_and_fro(changes):
    """Speed reverses on and between sector edges; 1 % as in the four quadrants."""
    state, parameters = drive_with(changes)
    torques = []
    for k in range(1000):
        advance_drive(state, parameters, 12.0, 10.0 * math.sin(0.02 * k), BUS_VOLTAGE, 1e-3)
        torques.append(state["mean_torque"])
    assert np.mean(torques[50:]) == pytest.approx(12.0, rel=0.01)
    assert 0.0 <= state["sector_angle"] <= SECTOR


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"averaged.sampling_period": 1e-3}, "averaged.current_controller.bandwidth"),
        ({"switched.current_controller.bandwidth": 5e4}, "switched.current_controller.bandwidth"),
        ({"drive": "perfect"}, "drive"),
    ],
)
def test_settings_that_cannot_work_are_refused_by_name(changes, name):
    with pytest.raises(ParameterError, match=name):
        build(DriveParameters, changes)
