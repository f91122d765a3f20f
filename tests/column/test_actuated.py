"""Steer-by-wire with an actuator of its own (Shchur 2019, introduction), and road feel by a motor."""

from __future__ import annotations

import math

import pytest
from column.columns import CAR, LEVER, RATIO, K, wheels_with

from ev_msgs_py.contract.record import names
from ev_msgs_py.contract.signals import DriverCommand
from ev_msgs_py.lockstep.methods import create, find_method
from ev_msgs_py.parameters.values import build

PERIOD = 0.005
METHOD = find_method("steering_column", "actuated")
FREE = {"steering_wheel.centring_stiffness": 0.001}  # a steering wheel without a spring worth speaking of


class Actuated:
    """The column in plain Python, and its state by name."""

    def __init__(self, **changed) -> None:
        self.made = create(METHOD, build(METHOD.parameters, changed), CAR, PERIOD)
        self.names = names(METHOD.law.state())

    def hold(self, seconds: float, hand_torque: float, difference: float = 0.0) -> dict[str, float]:
        """The state after some time with a hand torque and a torque difference of the drives [N m]."""
        for _ in range(round(seconds / PERIOD)):
            self.made.advance(DriverCommand(0.0, 0.0, hand_torque), wheels_with(difference))
        return dict(zip(self.names, self.made.state, strict=True))


def test_road_wheels_turn_to_the_angle_that_the_steering_wheel_sets():
    """1 N m on a spring of 0.25 N m/rad: 4 rad, so 4/i = 0.25 rad at the road wheels, exact by the integral part."""
    state = Actuated().hold(15.0, 1.0)
    assert state["angle"] == pytest.approx(4.0, rel=1e-6)
    assert state["road_wheel_angle"] == pytest.approx(4.0 / RATIO, rel=1e-6)
    assert state["actuator.torque"] == pytest.approx(K * 4.0 / RATIO, rel=1e-6)


def test_torque_difference_of_the_drives_is_a_disturbance():
    """10 N m more on the right would turn free road wheels by lever * 10/k_p = 0.38 rad; the actuator takes it all."""
    state = Actuated().hold(5.0, 0.0, difference=10.0)
    assert state["road_wheel_angle"] == pytest.approx(0.0, abs=1e-5)
    assert state["actuator.torque"] == pytest.approx(-10.0 * LEVER, rel=1e-4)


def test_rate_is_what_the_motor_can_do():
    """Steering wheel thrown to 10 rad/s: the road wheels follow at no more than 300 rad/s over the gear of 200."""
    column, last, fastest = Actuated(**FREE), 0.0, 0.0
    for _ in range(100):
        angle = column.hold(PERIOD, 6.0)["road_wheel_angle"]
        fastest, last = max(fastest, (angle - last) / PERIOD), angle
    assert 1.2 < fastest < 300.0 / 200.0


@pytest.mark.parametrize("feel", [0.0, 1.0])
def test_road_feel_is_that_of_a_mechanical_column(feel):
    """To hold 30 deg at the road wheels takes k_p 30 deg/i = 2.127 N m (shchur.hold30.manual) beside the own spring.

    Without feel only that: 0.25 N m/rad times i 30 deg.
    """
    hold = K * math.radians(30.0) / RATIO
    state = Actuated(**{"feel": feel, "feel_motor.peak_torque": 5.0}).hold(
        15.0, feel * hold + 0.25 * RATIO * math.radians(30.0)
    )
    assert state["road_wheel_angle"] == pytest.approx(math.radians(30.0), rel=0.002)
    assert state["feel_motor.torque"] == pytest.approx(-feel * hold, rel=0.002, abs=1e-12)


def test_losses_of_the_motor():
    """Held at 0.25 rad: T = 16.25 N m over the gear of 200, 4 T^2 = 0.026 W, and 3 W without any torque."""
    column = Actuated()
    before = column.hold(15.0, 1.0)
    after = column.hold(10.0, 1.0)
    power = 4.0 * (K * 0.25 / 200.0) ** 2 + 3.0
    assert after["actuator.loss"] - before["actuator.loss"] == pytest.approx(10.0 * power, rel=1e-6)
    assert after["actuator.work"] >= 0.5 * K * 0.25**2  # the spring of the road wheels, and what friction took
