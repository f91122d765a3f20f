"""A driver who follows a path."""

from __future__ import annotations

from driving import CENTRED, at, driver_of

from ev_msgs_py.contract.signals import BodyPose, Instant


def test_path_follower_turns_the_steering_wheel_towards_the_path():
    for side in (1.0, -1.0):
        driver = driver_of("path_follower")
        command = driver.step(Instant(0.0), at(5.0), BodyPose.at(0.0, -side, 0.0), CENTRED)
        assert command.hand_torque * side > 0.0
