"""Faults of the car: what each does to a car that is driven straight on, or at rest."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from ev_core.elementary import cos
from ev_sim.drives.brushless_motor import torque_share
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, load_scenario

CAR = "step_steer"
GONE = 1e-3  # [N m], of hundreds: 90 ms after it, 18 lags of the motor


@cache
def driven(*faults: str, battery: float = 120e3) -> Recording:
    """The front-driven car from 20 m/s on, straight, torque from 400 to 700 N m in 3 s."""
    values = [
        ("plant", "faults", list(faults)),
        ("steering_column", "profile.time", [0.0, 1.0]),
        ("steering_column", "profile.angle", [0.0, 0.0]),
        ("driver", "pedals.begin", True),
        ("driver", "pedals.time", [0.0, 3.0]),
        ("driver", "pedals.drive_torque", [400.0, 700.0]),
        ("driver", "pedals.brake_torque", [0.0, 0.0]),
        ("*", "vehicle.battery.discharge_power", battery),
    ]
    run = load_scenario(CAR, Overrides(values=values), only=("left",)).runs[0]
    return run_offline(run.configurations, 3.0)


def of(run: Recording, name: str) -> np.ndarray:
    return run.channels[name]


def effort(run: Recording, wheel: str) -> np.ndarray:
    return of(run, f"wheel_states.effort.{wheel}")


def test_a_sound_car_runs_straight():
    assert not of(driven(), "twist.yaw_rate").any()
    assert (effort(driven(), "front_left") == effort(driven(), "front_right")).all()


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_a_dead_motor_turns_the_car_to_its_own_side(side, sign):
    """The other one pushes its side ahead.

    With the wheels held straight the yaw moment is d/2 of its force.
    """
    run = driven(f"motor_share {side} 0 from 1")
    assert not of(run, "twist.yaw_rate")[:101].any()
    assert abs(effort(run, f"front_{side}")[110:]).max() < GONE
    assert sign * of(run, "twist.yaw_rate")[-1] > 0.01
    force = of(run, f"tire_forces.longitudinal_force.front_{'right' if side == 'left' else 'left'}")
    moment = 0.5 * 1.462 * force[103]
    growth = np.gradient(of(run, "twist.yaw_rate"), 0.01)[103] * 1900.0
    # rolling resistance of the others, tyres that begin to resist
    assert 0.5 * moment < sign * growth < 1.1 * moment


def test_mirrored_faults_are_mirrored_to_the_bit():
    left, right = (
        of(driven(f"motor_share {side} 0 from 1"), "twist.yaw_rate") for side in ("left", "right")
    )
    assert (left == -right).all()


def test_a_fault_ends():
    """After 1.5 s the torque is back, and the motor's lag of 5 ms has gone by."""
    run = driven("motor_share front_left 0.25 from 1 until 1.5")
    one, two = effort(run, "front_left"), effort(run, "front_right")
    assert one[120:150] == pytest.approx(0.25 * two[120:150], rel=1e-6)
    assert one[160:] == pytest.approx(two[160:], rel=1e-6)
    assert (one[:101] == two[:101]).all()


def test_a_stuck_motor_keeps_its_torque():
    run = driven("motor_stuck front_left from 1")
    kept = effort(run, "front_left")[100]
    assert kept > 100.0
    # The torque at the shaft is stuck; behind the gear there is nothing between.
    assert effort(run, "front_left")[105:] == pytest.approx(kept, rel=0.01)


def test_an_inverter_trips_and_stays_off_until_the_fault_ends():
    """The driver's 75 N m at the shaft and 20 m/s trip it at 40 N m; a limit of 1e4 never trips."""
    run = driven("inverter_trip front_left 40 from 1 until 2")
    assert abs(effort(run, "front_left")[110:200]).max() < GONE
    assert effort(run, "front_left")[-1] > 40.0
    untripped = driven("inverter_trip front_left 1e4 from 1 until 2")
    assert (effort(untripped, "front_left") == effort(driven(), "front_left")).all()


def test_a_delayed_inverter_does_the_same_later():
    """The first 0.2 s it has heard nothing.

    Then its command is that of 0.2 s ago, the lags being the same.
    """
    run = driven("inverter_delay front 0.2")
    command = of(run, "torque_command.drive.front_left")
    assert not effort(run, "front_left")[:20].any()
    # less half a period and a lag
    assert effort(run, "front_left")[60:] == pytest.approx(command[39:-21], rel=0.01)


def test_the_battery_limits_both_alike():
    """A cut-off leaves no drive torque.

    A share of the limits leaves a share of the power at most.
    """
    cut = driven("battery_share battery 0 from 1")
    for wheel in ("front_left", "front_right"):
        assert abs(effort(cut, wheel)[110:]).max() < GONE
    assert not of(cut, "twist.yaw_rate").any()
    full, half = (driven(*f, battery=30e3) for f in ((), ("battery_share battery 0.5",)))
    power = [
        float((-of(r, "battery.voltage") * of(r, "battery.current")).max()) for r in (full, half)
    ]
    assert power[1] < 1.01 * 15e3 < 29e3 < power[0] < 1.01 * 30e3


def test_a_puncture_pulls_to_its_side_and_ends():
    left, right = (driven(f"puncture front_{side} 1 from 1") for side in ("left", "right"))
    # harder to roll and turning faster: the left side stays behind
    assert of(left, "twist.yaw_rate")[150] > 1e-3
    assert (of(left, "twist.yaw_rate") == -of(right, "twist.yaw_rate")).all()
    turns = of(left, "wheel_states.velocity.front_left") / of(left, "twist.longitudinal")
    rolls = turns * (1.0 - of(left, "tire_forces.slip_ratio.front_left"))
    # the wheel's own speed in the turn
    assert rolls[-1] / rolls[90] == pytest.approx(1 / 0.9, rel=0.005)
    over = driven("puncture front_left 1 from 1 until 1.5")
    ratio = of(over, "wheel_states.velocity.front_left") / of(
        over, "wheel_states.velocity.front_right"
    )
    assert ratio[-1] == pytest.approx(1.0, abs=0.01)


def test_a_stuck_hall_sensor_costs_a_third_of_the_torque():
    """(3 + 1/2 + 0 + 1/2) / 6; a sector without torque; the same a turn later and a turn before."""
    angles = np.linspace(0.0, math.tau, 6001)[:-1] + 1e-6
    shares = np.array([torque_share(a) for a in angles])
    assert shares.mean() == pytest.approx(2 / 3, abs=1e-3)
    assert (shares == 0.0).mean() == pytest.approx(1 / 6, abs=1e-3)
    assert [torque_share(a - math.tau) for a in angles[::500]] == pytest.approx(
        shares[::500].tolist(), abs=1e-9
    )
    assert cos(0.0) == torque_share(0.0)
