"""Losses of motor and inverter, by coefficients and by an efficiency map."""

from __future__ import annotations

import numpy as np
import pytest

from ev_core.vehicle.losses import loss_power, map_loss_power
from ev_core.vehicle.motor import Motor


def test_losses_and_efficiency_map_agree():
    """A map of the loss model gives its values at the points, driving and generating."""
    speeds, torques = np.linspace(50.0, 500.0, 4), np.linspace(20.0, 200.0, 5)
    motor = Motor()
    power = speeds[:, None] * torques[None, :]
    loss = np.array([[loss_power(motor, t, w) for t in torques] for w in speeds])
    efficiency = power / (power + loss)
    by_speed = efficiency.ravel()
    assert map_loss_power(torques[2], speeds[1], speeds, torques, by_speed) == pytest.approx(
        loss[1, 2]
    )
    generated = map_loss_power(-torques[2], speeds[1], speeds, torques, by_speed)
    assert generated == pytest.approx(power[1, 2] * (1.0 - efficiency[1, 2]))


SPEEDS, TORQUES = np.array([50.0, 100.0, 400.0]), np.array([10.0, 100.0])
EFFICIENCY = np.array([0.5, 0.6, 0.8, 0.7, 0.85, 0.95])  # for each speed a row over the torques


def test_torque_at_standstill_costs_what_the_lowest_speed_of_the_map_does():
    """100 N m at 50 rad/s and 0.6: 5000 W (1/0.6 - 1), whichever way the motor is about to turn.

    No torque, no loss.
    """
    for speed in (0.0, 1e-12, -1e-12, 25.0, 50.0):
        assert map_loss_power(100.0, speed, SPEEDS, TORQUES, EFFICIENCY) == pytest.approx(
            5000.0 * (1 / 0.6 - 1.0)
        )
    assert map_loss_power(-100.0, 0.0, SPEEDS, TORQUES, EFFICIENCY) == pytest.approx(
        5000.0 * (1 / 0.6 - 1.0)
    )
    assert map_loss_power(0.0, 0.0, SPEEDS, TORQUES, EFFICIENCY) == 0.0


def test_a_row_at_standstill_is_not_looked_at():
    """Every efficiency at speed zero means the same power, none."""
    speeds = np.array([0.0, *SPEEDS])
    for row in (0.01, 1.0):
        efficiency = np.concatenate((np.full(2, row), EFFICIENCY))
        for torque, speed in ((100.0, 0.0), (100.0, 20.0), (-60.0, 20.0)):
            assert map_loss_power(torque, speed, speeds, TORQUES, efficiency) == map_loss_power(
                torque, speed, SPEEDS, TORQUES, EFFICIENCY
            )


@pytest.mark.slow
@pytest.mark.parametrize("torque", [100.0, -100.0, 37.0])
def test_losses_of_a_map_have_no_jumps(torque):
    """Steps of 0.01 rad/s from reverse through rest to beyond the map.

    1 W, the steepest part is 67 W s/rad.
    """
    speeds = np.arange(-450.0, 450.0, 0.01)
    losses = np.array(
        [map_loss_power(torque, speed, SPEEDS, TORQUES, EFFICIENCY) for speed in speeds]
    )
    assert np.abs(np.diff(losses)).max() < 1.0
    assert losses.min() > 0.0
