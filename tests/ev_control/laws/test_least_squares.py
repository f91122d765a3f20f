"""Traction control by the slip curve's peak, by least squares (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from helpers.launches import (
    HELD_SURFACES,
    NOISE,
    PEAK_SLIP,
    Channels,
    driven,
    friction_use,
    is_limited,
    launch,
    slip_of,
)
from helpers.traction import INERTIA, PERIOD, Control, spinning_at

from ev_control.asr.least_squares import LeastSquaresParameters
from ev_core.parameters.data_file import find_file
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError


def test_relations_of_parameters_are_checked():
    with pytest.raises(
        ParameterError, match=r"backstop is 0\.05, expected at least least_slip and first_slip"
    ):
        LeastSquaresParameters(backstop=0.05)


def test_backstop_by_hand():
    """Slip 0.5 at once, without road filter.

    M_road, plus J (a_x/(r (1 - 0.08)) + 25 (10/(1 - 0.08) - 20)).

    1500 N m of torque and 1 m/s^2; the wheel jumps from 19.9 to 20 rad/s, w' = 20 rad/s^2, so that
    it is the road that takes the torque.
    """
    law = Control("least_squares", road_filter=0.0, first_slip=0.08)
    law.step(spinning_at(10.0, 10.0))
    law.step(spinning_at(14.0, 10.0))  # slip 0.286
    assert law.limits()[0] == math.inf
    law.step(spinning_at(19.9, 10.0))
    limit = law.step(spinning_at(20.0, 10.0)).front_left
    road = 1500.0 - INERTIA * 0.1 / PERIOD
    wanted = 10.0 / (1.0 - 0.08)
    expected = road + INERTIA * (1.0 / (0.32 * (1.0 - 0.08)) + 25.0 * (wanted - 20.0))
    assert law.of_wheel()["target"] == 0.08
    assert limit == pytest.approx(expected, rel=1e-9)


def test_target_is_below_the_speed_that_grows_without_bound():
    """A hit at a slip beyond 0.9, as behind a car that rolls back, regulates to 0.9.

    No number gets out of hand.
    """
    law = Control("least_squares", hits=1, spread=0.0, window=0.05)
    for n in range(60):
        speed = 1.0 + 0.1 * n
        m = spinning_at(speed, speed)
        torque = 1500.0 * math.exp(-0.05 * n)
        rolling_back = m.speed._replace(rear_left=-1.0, rear_right=-1.0)
        limits = law.step(
            dataclasses.replace(m, speed=rolling_back, torque=m.torque._replace(front_left=torque))
        )
        assert all(math.isfinite(limit) for limit in limits)
        assert law.of_wheel()["target"] <= 0.9


def test_a_changed_window_takes_effect_at_once():
    """The state of a law with 0.125 s in one with 0.05 s.

    After the next sample the fit is that of the last ten.
    """
    before, after = Control("least_squares"), Control("least_squares", window=0.05)
    steps = [spinning_at(10.0 + 0.2 * math.sin(n) + 0.05 * n, 10.0) for n in range(60)]
    for m in steps[:40]:
        before.step(m)
        after.step(m)
    after_all = after.of_wheel()
    moved = Control("least_squares", window=0.05)
    moved.law.state = before.law.state
    moved.step(steps[40])
    after.step(steps[40])
    for name in ("sum_x", "sum_xx", "sum_x_root", "sum_xy", "sum_root_y"):
        name = f"curve.fit.{name}"
        # A running sum of ten terms against a new sum: rounding of a few of them.
        assert moved.of_wheel()[name] == pytest.approx(after.of_wheel()[name], rel=1e-13)
    assert moved.of_wheel()["curve.fit.size"] == 10.0
    assert after_all["curve.fit.taken"] == 40.0


# What the specification asks for


def pressed_slowly(surface: str) -> Channels:
    """A pedal that takes 6 s: what passes the peak is the torque, not the wheel's inertia."""
    return launch("least_squares", (surface,), 3800.0, 6.0, 12.0)


@pytest.mark.parametrize("wheel", ["front_left", "front_right"])
@pytest.mark.parametrize("surface", HELD_SURFACES)
def test_least_squares_hits_at_the_peak_and_stays_there(surface, wheel):
    """The first hit has at least 97 % of the peak friction.

    Then 0.8..1.5 S* on the mean and for most of the time.

    Measured with eight seeds: 97.1 % and more; means of 0.88 to 1.38 S*; 70 to 99 % of the time
    inside. The curve is flat about the peak, so even the rest of the time costs little: the
    friction in use is at least 99 % on the mean.
    """
    channels, star = pressed_slowly(surface), PEAK_SLIP[surface]
    first = int(np.argmax(is_limited(channels, wheel)))
    assert first > 0
    use = friction_use(channels, wheel)
    assert use[first] >= 0.97
    slip = slip_of(channels, wheel)[first + 100 :]  # half a second for the first approach
    assert 0.8 * star < slip.mean() < 1.5 * star
    assert np.mean((slip > 0.8 * star) & (slip < 1.5 * star)) > 0.65
    assert use[first + 100 :].mean() > 0.99


@pytest.mark.parametrize("wheel", ["front_left", "front_right"])
def test_least_squares_settles_far_behind_the_peak_of_packed_snow_2(wheel):
    """S* = 0.06 is passed within two samples, before the window knows.

    2.5 to 3.2 S* on the mean with three seeds.

    The curve falls so little behind the peak that 96 to 97 % of the friction are in use all the
    same.
    """
    channels = pressed_slowly("packed_snow_2")
    first = int(np.argmax(is_limited(channels, wheel)))
    assert 2.2 * 0.0600 < slip_of(channels, wheel)[first + 100 :].mean() < 3.5 * 0.0600
    assert 0.95 < friction_use(channels, wheel)[first + 100 :].mean() < 0.98


@pytest.mark.slow
def test_least_squares_leaves_dry_driving_alone():
    """580 s of the TRRL cycle on dry asphalt.

    Not a single hit, and so the same torques to the bit.
    """
    channels = driven(
        580.0,
        ("plant", "road.left", ("dry_asphalt",)),
        ("plant", "road.right", ("dry_asphalt",)),
        ("driver", "method", "speed_profile"),
        ("driver", "speed_profile.file", str(find_file("cycles/trrl_1_1.csv"))),
        ("driver", "speed_control.max_drive_torque", 4000.0),
        ("steering_column", "method", "manual"),
        ("asr", "method", "least_squares"),
        *NOISE,
    )
    assert channels["twist.longitudinal"].max() > 13.0  # 48 km/h: the cycle was driven
    for wheel in ("front_left", "front_right"):
        command, request = (
            channels[f"torque_command.drive.{wheel}"],
            channels[f"torque_request.drive.{wheel}"],
        )
        np.testing.assert_array_equal(command, request)


def test_least_squares_on_ice_ends_the_spin_by_its_backstop():
    """Ice has no peak: the slip swings below the backstop of 0.3 once it counts."""
    channels = launch("least_squares", ("ice",), 3000.0, 1.0, 12.0)
    fast = channels["wheel_states.velocity.rear_left"] > 4.0
    assert fast.sum() > 400
    assert slip_of(channels)[fast].mean() < 0.3


@pytest.mark.parametrize("surface", HELD_SURFACES)
def test_the_observer_takes_the_place_of_free_wheels(surface):
    """The same car with the observer instead.

    The mean slip is still less than twice that of the peak.
    """
    more = (("asr", "reference.source", "observer"),)
    channels = launch("least_squares", (surface,), 3000.0, 1.0, 5.0, (), more)
    assert 0.5 * PEAK_SLIP[surface] < slip_of(channels)[400:].mean() < 2.0 * PEAK_SLIP[surface]


def test_a_car_that_drives_all_four_wheels_has_traction_control():
    """Snow, 1250 N m at each wheel: a fifth faster at least, with a third of the slip.

    No wheel shows the speed.
    """
    more = (("*", "vehicle.driven_wheels", WHEEL_NAMES),)
    off, on = (
        launch(law, ("packed_snow_1",), 5000.0, 1.5, 6.0, (), more)
        for law in ("off", "least_squares")
    )
    for wheel in WHEEL_NAMES:
        assert slip_of(on, wheel)[300:].mean() < slip_of(off, wheel)[300:].mean() / 3
    assert on["twist.longitudinal"][-1] > 1.2 * off["twist.longitudinal"][-1]


def test_least_squares_at_the_default_period():
    """10 ms halve the window's samples.

    Still within 0.8..1.5 S* on the mean of 6 s (1.2 to 1.4 with eight seeds).
    """
    channels = launch(
        "least_squares", ("packed_snow_1",), 3800.0, 6.0, 12.0, (), (("*", "control_period", 0.01),)
    )
    assert 0.8 * 0.0907 < slip_of(channels)[600:].mean() < 1.5 * 0.0907
