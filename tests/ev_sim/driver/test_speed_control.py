"""The driver's feet: limits, stopping, standing, reversing."""

from __future__ import annotations

import pytest
from helpers.driving import CAR, CENTRED, PERIOD, PointMass, at, driver_of, ride
from hypothesis import given
from hypothesis import strategies as st

from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.signals import DriverCommand, Instant
from ev_sim.driver.pedals import SpeedControlParameters, SpeedControlState, follow_speed

LIMITS, NUMBERS = SpeedControlParameters(), namespace(car_numbers(CAR))
HELD = 2.0 * 1400.0 * 9.81 * 0.294  # N m, of the brake while it holds


@pytest.mark.parametrize(
    ("wanted", "speed", "drive", "brake"),
    [
        # P 600 and I 3: the drives brake to their limit, the brakes do the rest
        (9.7, 10.0, -600.0, 3.0),
        (9.9, 10.0, -201.0, 0.0),  # the drives alone
        (0.0, 20.0, -600.0, 4000.0),  # everything
        (20.0, 0.0, 1500.0, 0.0),
        (-9.7, -10.0, 600.0, 3.0),  # the same backwards
        (-20.0, 0.0, -1500.0, 0.0),
        (-0.5, 0.02, -1045.2, 0.0),  # reversing: hardly rolling forwards counts as standing
        (0.0, 0.05, 0.0, HELD),
    ],
)
def test_first_step_by_hand(wanted, speed, drive, brake):
    """2000 N m s/m and 1000 N m/m * 10 ms times the error, within the limits."""
    driver = driver_of("speed_profile", speed_profile__time=(0.0,), speed_profile__speed=(wanted,))
    command = driver.step(Instant(0.0), at(speed), CENTRED)
    assert command == DriverCommand(pytest.approx(drive), pytest.approx(brake), 0.0)


@given(
    wanted=st.lists(st.floats(-30.0, 30.0), min_size=1, max_size=20),
    speeds=st.lists(st.floats(-30.0, 30.0), min_size=1, max_size=20),
)
def test_pedals_keep_their_limits_and_mirror_in_reverse(wanted, speeds):
    """Limits hold, drives do not drive against the brakes, reverse is the mirror image."""
    feet, mirrored = SpeedControlState(), SpeedControlState()
    for target, speed in zip(wanted * len(speeds), speeds * len(wanted), strict=True):
        drive, brake = follow_speed(LIMITS, NUMBERS, feet, PERIOD, target, speed)
        assert follow_speed(LIMITS, NUMBERS, mirrored, PERIOD, -target, -speed) == (-drive, brake)
        assert mirrored == SpeedControlState(-feet.integral, feet.holds)
        assert abs(drive) <= LIMITS.max_drive_torque
        assert 0.0 <= brake <= (HELD if feet.holds else LIMITS.max_brake_torque)
        assert not feet.holds or target == drive == 0.0
        if drive * speed < 0.0 and abs(speed) > LIMITS.standstill_speed:
            assert abs(drive) <= LIMITS.max_regenerative_torque
        if brake > 0.0:
            assert drive * speed <= 0.0


def test_speed_control_recovers_from_its_limit():
    """A jump to 20 m/s holds the drive torque at its limit for about 6 s.

    The overshoot stays below 0.5 %.

    What remains is the little that the integral part gains outside the limit. Wound up over 6 s it
    would be worth 1000 * 20 * 6/2 = 60000 N m and the overshoot above 50 %.
    """
    rows = ride(
        driver_of("speed_profile", speed_profile__time=(0.0,), speed_profile__speed=(20.0,)),
        PointMass(),
        40.0,
    )
    limited = [time for time, _, command in rows if command.drive_torque == LIMITS.max_drive_torque]
    assert max(limited) > 5.0
    assert max(speed for _, speed, _ in rows) < 20.0 * 1.005
    assert rows[-1][1] == pytest.approx(20.0, rel=1e-3)


def test_stop_and_stand():
    """The car stops from 10 m/s within 4 s, by regeneration alone.

    Then it stands exactly, on the brake.
    """
    driver = driver_of(
        "speed_profile",
        speed_profile__time=(0.0, 2.0, 12.0),
        speed_profile__speed=(10.0, 10.0, 0.0),
    )
    rows = ride(driver, PointMass(10.0), 20.0)
    assert max(command.brake_torque for time, _, command in rows if time < 12.0) == 0.0
    assert {(speed, command) for time, speed, command in rows if time > 16.0} == {
        (0.0, DriverCommand(0.0, HELD, 0.0))
    }


def test_drive_backwards_and_forwards_again():
    """-3 m/s, stop, +3 m/s: each within 1 % after 8 s."""
    driver = driver_of(
        "speed_profile",
        speed_profile__time=(0.0, 3.0, 13.0, 16.0, 20.0, 23.0),
        speed_profile__speed=(0.0, -3.0, -3.0, 0.0, 0.0, 3.0),
    )
    speed_at = {round(time, 2): speed for time, speed, _ in ride(driver, PointMass(), 33.0)}
    assert speed_at[13.0] == pytest.approx(-3.0, rel=0.01)
    assert speed_at[20.0] == 0.0
    assert speed_at[33.0] == pytest.approx(3.0, rel=0.01)
