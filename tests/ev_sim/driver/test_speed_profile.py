"""The driver of the paper: its cycle, its hand torque, its file."""

from __future__ import annotations

import pytest
from helpers.driving import CAR, CENTRED, PERIOD, PointMass, at, driver_of, ride

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.values import build
from ev_msgs_py.contract.signals import DriverCommand, Instant
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.pedals import SpeedControlParameters
from ev_sim.profiles.profile import profile_of, value_at


def test_driver_is_registered_and_its_defaults_start_at_rest():
    """The paper's cycle stands at t = 0: the brake holds, the hands rest."""
    holding = SpeedControlParameters().holding_share * CAR.mass * 9.81 * CAR.wheel_radius
    assert driver_of("speed_profile").step(Instant(0.0), at(0.0), CENTRED) == DriverCommand(
        0.0, holding, 0.0
    )


def test_default_driver_follows_the_cycle_of_the_paper():
    """Fig 4: 15 km/h from 4 s, 30 km/h from 29 s.

    Within 1 km/h on the ramps, within 1 % once they are over for 5 s.

    The slower pole of the control is at 0.57/s, so 5 s leave e^-2.8 of the 0.2 m/s that the ramp
    leaves.
    """
    wanted = profile_of((0.0, 4.0, 25.0, 29.0), (0.0, 15 / 3.6, 15 / 3.6, 30 / 3.6), "linear")
    rows = ride(driver_of("speed_profile"), PointMass(), 50.0)
    assert max(abs(speed - value_at(wanted, time)) for time, speed, _ in rows) < 1 / 3.6
    steady = [(time, speed) for time, speed, _ in rows if 9.0 < time < 25.0 or time > 34.0]
    assert all(speed == pytest.approx(value_at(wanted, time), rel=0.01) for time, speed in steady)
    assert rows[-1][1] == pytest.approx(30 / 3.6, rel=1e-4)


def test_hand_torque_profile_passes_through():
    driver = driver_of(
        "speed_profile",
        steering__mode="hand_torque",
        steering__hand_torque__time=(0.0, 1.0),
        steering__hand_torque__torque=(0.0, 5.0),
    )
    assert [
        driver.step(Instant(t), at(0.0), CENTRED).hand_torque for t in (0.0, 0.99, 1.0, 7.0)
    ] == [
        0.0,
        0.0,
        5.0,
        5.0,
    ]


def test_driver_reads_files_only_on_request(tmp_path):
    method = find_method("driver", "speed_profile")
    path = tmp_path / "cycle.csv"
    path.write_text("t_s,v_mps\n0,7\n")
    parameters = build(method.parameters, {"speed_profile.file": str(path)})
    with pytest.raises(
        ParameterError,
        match=r"^speed_profile.file: .*cycle.csv has not been read into time and speed$",
    ):
        create(method, parameters, CAR, PERIOD)
    driver = create(method, method.law.load_files(parameters), CAR, PERIOD)
    assert driver.step(Instant(0.0), at(7.0), CENTRED) == DriverCommand(0.0, 0.0, 0.0)
