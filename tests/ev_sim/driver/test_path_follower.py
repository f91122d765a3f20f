"""The driver that follows a path."""

from __future__ import annotations

from helpers.driving import CENTRED, at, driver_of

from ev_msgs_py.contract.signals import BodyPose, Instant


def test_path_follower_turns_the_steering_wheel_towards_the_path():
    for side in (1.0, -1.0):
        driver = driver_of("path_follower")
        command = driver.step(Instant(0.0), at(5.0), BodyPose.at(0.0, -side, 0.0), CENTRED)
        assert command.hand_torque * side > 0.0


def test_a_car_that_leaves_its_road_says_so():
    """The edge of 7 m is 3.5 m beside the path; the first time and the largest distance count."""
    driver = driver_of("path_follower")
    for time, aside in ((0.0, 1.0), (1.0, -3.4)):
        driver.step(Instant(time), at(5.0), BodyPose.at(5.0 * time, aside, 0.0), CENTRED)
    assert driver.reports() == ()
    for time, aside in ((2.0, -4.0), (3.0, -20.0), (4.0, 0.0)):
        driver.step(Instant(time), at(5.0), BodyPose.at(5.0 * time, aside, 0.0), CENTRED)
    assert driver.reports() == (
        "the car left the road at 2.00 s and has been more than 10 m from its path",
    )


def test_at_rest_the_eyes_stay_where_they_were():
    """A velocity of rounding does not turn them round: the hands do the same whatever its sign."""
    torques = []
    for speed in (1e-35, -1e-35, 0.0):
        driver = driver_of("path_follower")
        torques.append(
            driver.step(Instant(0.0), at(speed), BodyPose.at(0.0, -1.0, 0.3), CENTRED).hand_torque
        )
    assert torques[0] == torques[1] == torques[2]
