"""The three drivers of the urban cycle on mixed surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.urban_runs import CAR, PARAMETERS, driven, modes

from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.driver.urban_drivers import PowerLevelParameters, torque_of_power
from ev_sim.profiles.cycle_windows import MODES, TRACTION

NUMBERS, LEVEL = namespace(car_numbers(CAR)), PowerLevelParameters()


def test_tracking_stays_within_half_a_metre_per_second():
    """Measured are 0.46 m/s, where a window of traction begins to slow down on asphalt."""
    run = driven("tracking")
    error = run.channels["twist.longitudinal"] - cycle.wanted_speed(run, PARAMETERS["driver"])
    assert np.abs(error).max() < 0.5


def test_tracking_never_brakes_in_traction():
    run = driven("tracking")
    inside = modes(run) == MODES[TRACTION]
    assert run.channels["driver.command.drive_torque"][inside].min() >= 0.0
    assert run.channels["driver.command.brake_torque"][inside].max() == 0.0


def test_imposed_speed_is_the_cycle():
    run = driven("imposed_speed")
    wanted = cycle.wanted_speed(run, PARAMETERS["driver"])
    assert np.abs(run.channels["twist.longitudinal"] - wanted).max() < 1e-6


@pytest.mark.parametrize("driver", ["pulse", "imposed_speed"])
def test_pedal_is_at_the_power_or_released(driver):
    """The pedal is one of both in traction windows; `imposed_speed` never releases it."""
    run = driven(driver)
    c = run.channels
    speed = np.copysign(
        np.hypot(c["twist.longitudinal"], c["twist.lateral"]), c["twist.longitudinal"]
    )
    asked = c["driver.command.drive_torque"]
    velocity = np.array([c[f"wheel_states.velocity.{wheel}"] for wheel in WHEEL_NAMES]).T
    inside = np.flatnonzero(modes(run) == MODES[TRACTION])
    expected = np.array(
        [
            torque_of_power(
                LEVEL,
                NUMBERS,
                speed[i],
                WheelStates(NO_WHEELS, Wheels(*velocity[i].tolist()), NO_WHEELS),
            )
            for i in inside
        ]
    )
    pressed = np.isclose(asked[inside], expected, rtol=1e-12, atol=0.0)
    assert (pressed | (asked[inside] == 0.0)).all()
    assert c["driver.command.brake_torque"][inside].max() == 0.0
    assert pressed.all() if driver == "imposed_speed" else 0.05 < pressed.mean() < 0.95


def test_foot_goes_down_below_the_cycle_and_up_above_it():
    """0.3 m/s on either side (assumption); one period later the car is little faster."""
    run = driven("pulse")
    error = run.channels["twist.longitudinal"] - cycle.wanted_speed(run, PARAMETERS["driver"])
    pressed = run.channels["driver.command.drive_torque"] > 0.0
    inside = modes(run) == MODES[TRACTION]
    turns = np.flatnonzero((pressed[1:] != pressed[:-1]) & inside[1:] & inside[:-1]) + 1
    assert len(turns) > 20
    assert np.where(pressed[turns], error[turns], -error[turns]).max() <= -0.3
    assert np.abs(error[turns]).max() < 0.35


@pytest.mark.parametrize("driver", ["tracking", "pulse"])
def test_car_stands_in_stop_windows(driver):
    """The car stands within 1 mm from one second into the window.

    The regeneration before ends at rest.
    """
    run = driven(driver)
    for start, end in ((0.0, 15.7), (72.9, 89.0)):
        inside = (run.time >= start + 1.0) & (run.time < end)
        assert np.ptp(run.channels["pose.x"][inside]) < 1e-3
        assert run.channels["driver.command.drive_torque"][inside].max() == 0.0
        assert run.channels["driver.command.brake_torque"][inside][-1] > 0.0
