"""Steer-by-wire with its own actuator (Shchur 2019, introduction), road feel by a motor."""

from __future__ import annotations

import math

import pytest
from column.columns import CAR, LEVER, RATIO, K, wheels_with

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.record import names
from ev_core.parameters.values import build
from ev_msgs_py.contract.signals import DriverCommand
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import load_scenario

PERIOD = 0.005
METHOD = find_method("steering_column", "actuated")


class Actuated:
    """The column in plain Python, and its state by name."""

    def __init__(self, **changed) -> None:
        self.made = create(METHOD, build(METHOD.parameters, changed), CAR, PERIOD)
        self.names = names(METHOD.law.state())

    def hold(self, seconds: float, hand_torque: float, difference: float = 0.0) -> dict[str, float]:
        """State after some time with a hand torque and a torque difference of the drives [N m]."""
        for _ in range(round(seconds / PERIOD)):
            self.made.advance(DriverCommand(0.0, 0.0, hand_torque), wheels_with(difference))
        return dict(zip(self.names, self.made.state, strict=True))


def test_road_wheels_turn_to_the_angle_that_the_steering_wheel_sets():
    """1 N m on a spring of 0.25 N m/rad.

    4 rad, so 4/i = 0.25 rad at the road wheels, exact by the integral part.

    It holds k_p 0.25 = 16.25 N m over the gear of 400, and takes the copper loss of that.
    """
    state = Actuated().hold(8.0, 1.0)
    assert state["angle"] == pytest.approx(4.0, rel=1e-3)
    assert state["actuator.angle"] == pytest.approx(state["angle"] / RATIO, rel=1e-3)
    torque = K * 0.25 / 400.0
    assert state["actuator.torque"] == pytest.approx(torque, rel=0.01)
    assert state["actuator.power"] == pytest.approx(20.0 * torque**2, rel=0.05)


def test_torque_difference_of_the_drives_is_a_disturbance():
    """10 N m more on the right would turn free road wheels by lever * 10/k_p = 0.38 rad.

    The actuator takes it all.
    """
    state = Actuated().hold(5.0, 0.0, difference=10.0)
    assert state["actuator.angle"] == pytest.approx(0.0, abs=1e-4)
    assert 400.0 * state["actuator.torque"] == pytest.approx(-10.0 * LEVER, rel=0.01)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_road_feel_is_that_of_a_mechanical_column(share):
    """30 deg take k_p 30 deg/i = 2.127 N m (shchur.hold30.manual) beside the own spring.

    That is all without feel: 0.25 N m/rad times i 30 deg.
    """
    hold, angle = K * math.radians(30.0) / RATIO, math.radians(30.0)
    state = Actuated(**{"feel.share": share}).hold(8.0, share * hold + 0.25 * RATIO * angle)
    assert state["actuator.angle"] == pytest.approx(angle, rel=0.01)
    assert state["feel"] == pytest.approx(-share * hold, rel=0.01, abs=1e-12)
    assert state["feel_power"] == pytest.approx(2.0 * (share * hold) ** 2, rel=0.02, abs=1e-12)


def test_rate_is_what_the_actuator_can_do():
    """Steering wheel thrown at more than 16 rad/s.

    The road wheels turn at 1 rad/s, with an overshoot of 4 %.
    """
    column, last, fastest = Actuated(), 0.0, 0.0
    for _ in range(60):
        state = column.hold(PERIOD, 10.0)
        fastest, last = (
            max(fastest, (state["actuator.angle"] - last) / PERIOD),
            state["actuator.angle"],
        )
    assert state["angle"] > 16.0 * state["actuator.angle"]
    assert 0.9 < fastest < 1.05


def test_scenario_steers_by_wire_with_and_without_feel():
    """Near rest hands hold the spring of the steering wheel, and k_p delta/i of the road.

    5 % is for friction and the damping of a turn that has not ended quite.
    """
    _, *by_wire = load_scenario("steer_by_wire").runs
    for run, share in zip(by_wire, (0.0, 1.0), strict=True):
        recorded = run_offline(run.configurations, 4.9)
        shown = {key: values[-1] for key, values in recorded.channels.items()}
        angle, road = (
            shown["steering_column.state.angle"],
            shown["steering_column.state.road_wheel_angle"],
        )
        assert road == pytest.approx(angle / RATIO, rel=0.01)
        expected = 0.25 * angle + share * K * road / RATIO
        assert shown["steering_column.state.hand_torque"] == pytest.approx(expected, rel=0.05)
