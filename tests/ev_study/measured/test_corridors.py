"""Corridors around simulated signals, on numbers with known answers."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from ev_study.measured.records.record import (
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
    sideslip,
)
from ev_study.measured.replays.corridors import STEERING, Corridor, CorridorParameters, corridors_of


def test_what_lies_inside_by_instants_ranges_and_medians():
    """1 + 10 % around 5 and -5 is 1.5.

    The errors of 1.4 lie inside, those of 1.6 do not, and NaN does not count.
    """
    acceleration = np.repeat([[3.5], [-9.5]], 200, axis=1)
    simulated = np.repeat([[5.0], [-5.0]], 200, axis=1)
    measured = simulated + np.where(np.arange(200) < 150, 1.4, 1.6)
    measured[1] = simulated[1] - 1.6
    measured[1, :20] = np.nan
    found = Corridor("rad", 1.0, 0.1, (acceleration, acceleration), simulated, measured)
    assert found.share == pytest.approx(150 / 380)
    assert found.shares == pytest.approx({"2 to 4": 0.75, "above 8": 0.0})
    at, one, other = found.curves
    assert (at.tolist(), one.tolist(), other.tolist()) == ([-9.5, 3.5], [-5.0, 5.0], [-6.6, 6.4])
    assert found.share_of_ranges == 0.5
    simulated[1, -50:] = np.nan  # the car has left all numbers behind, not the judge
    assert Corridor(
        "rad", 1.0, 0.1, (acceleration, acceleration), simulated, measured
    ).share == pytest.approx(150 / 380)
    none = Corridor(
        "rad", 1.0, 0.1, (acceleration, acceleration), simulated, np.full_like(simulated, np.nan)
    )
    assert np.isnan(none.share) and none.as_json() == {
        "share": None,
        "share_of_ranges": None,
        "by_range": {},
    }


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_steering_is_compared_by_curvature_and_at_rest_not_at_all(ahead):
    """Both cars stand at 3 deg.

    At 2.5 m and 10 m/s, 0.02 rad/s more are worth atan(L r/u): 0.005 rad less of it.

    In reverse the car turns the other way by the same angle.
    """
    speed, angle = np.array([[10.0 * ahead, 0.1]]), np.full((1, 2), 0.0524)
    slower, faster = (ahead * np.array([[rate, rate]]) for rate in (0.10, 0.12))
    signals = {
        LONGITUDINAL: speed,
        YAW_RATE: slower,
        ROAD_WHEEL_ANGLE: angle,
        SIDESLIP: 0.0 * angle,
    }
    measured = {LONGITUDINAL: speed, YAW_RATE: faster, SIDESLIP: 0.0 * angle}
    plant = SimpleNamespace(common=SimpleNamespace(vehicle=SimpleNamespace(wheelbase=2.5)))
    replay = SimpleNamespace(
        measured=measured.get, compared=[YAW_RATE, SIDESLIP], configurations={"plant": plant}
    )
    found = corridors_of(
        replay, signals, CorridorParameters(steering_angle_offset=0.004, steering_angle_gain=0.0)
    )
    steering = found[STEERING]
    assert steering.simulated[0, 0] == pytest.approx(0.0524 - np.arctan(0.025))
    assert (steering.simulated - steering.measured)[0, 0] == pytest.approx(0.005, rel=1e-2)
    assert steering.share == 0.0 and steering.counts.tolist() == [[True, False]]
    assert found[YAW_RATE].share == 1.0  # 0.02 of 0.0175 + 0.01
    assert found[SIDESLIP].share == 1.0


def test_sideslip_in_reverse_is_that_of_the_rear_and_a_car_that_has_turned_round_is_not_in_reverse():
    """atan2 of the velocities is 177 deg for a car that backs straight with 0.5 of 10 m/s aside."""
    measured = np.array([10.0, -10.0, 10.0])
    found = sideslip(np.array([10.0, -10.0, -10.0]), np.array([0.5, 0.5, 0.5]), measured)
    assert found == pytest.approx([np.arctan(0.05), -np.arctan(0.05), np.pi - np.arctan(0.05)])
