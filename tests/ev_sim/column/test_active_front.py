"""Active front steering: what it adds to the angle of the hands, how far and how fast."""

from __future__ import annotations

from typing import Any

import pytest

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import BodyVelocity, Instant, SteeringColumnState

PERIOD = 0.01
CAR = Vehicle()
HANDS = 0.8  # [rad]


class Active:
    """The column on a car with a given motion."""

    def __init__(self, **values: Any) -> None:
        method = find_method("steering_column", "active_front")
        named = {"profile.angle": [values.pop("hands", HANDS)]} | values
        self.column = create(method, build(method.parameters, named), CAR, PERIOD)
        self.n = 0

    def drive(self, body: BodyVelocity, seconds: float) -> SteeringColumnState:
        for _ in range(round(seconds / PERIOD)):
            there = {Instant: Instant(self.n * PERIOD), BodyVelocity: body}
            self.column.advance(
                *(there[signal] for signal in find_method("steering_column", "active_front").reads)
            )
            self.n += 1
        return self.column.outputs()[0]


def at_wanted(speed: float, hands: float = HANDS) -> float:
    """V tan(d)/L of the car without understeer [rad/s]."""
    return speed * hands / CAR.steering_ratio / CAR.wheelbase


def test_at_rest_and_slowly_nothing_is_added():
    for speed in (0.0, 0.9, -0.9):
        state = Active().drive(BodyVelocity(speed, 0.0, 1.0), 1.0)
        assert state.road_wheel_angle == HANDS / CAR.steering_ratio
        assert state.angle == HANDS


def test_a_car_that_turns_as_it_is_steered_gets_nothing():
    """Within the difference of tan(d) and d: d^3/3 of 0.05 rad, times V/L."""
    state = Active().drive(BodyVelocity(5.0, 0.0, at_wanted(5.0)), 1.0)
    assert state.road_wheel_angle == pytest.approx(HANDS / CAR.steering_ratio, abs=2e-4)


@pytest.mark.parametrize("speed", [8.0, -8.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_it_steers_against_too_much_yaw_whichever_way_the_car_goes(speed, sign):
    """0.04 rad/s that straight wheels do not ask for, times 1 s of gain, against it.

    Backwards the other way.
    """
    state = Active(hands=0.0).drive(BodyVelocity(speed, 0.0, sign * 0.04), 1.0)
    assert state.road_wheel_angle == pytest.approx(-sign * 0.04 * (1.0 if speed > 0.0 else -1.0))
    assert state.angle == 0.0  # the hands feel nothing


def test_wanted_is_no_more_than_the_road_gives():
    """A car at the road's 3/20 rad/s gets nothing, though the hands ask for 0.4 rad/s."""
    assert at_wanted(20.0) > 0.15
    state = Active().drive(BodyVelocity(20.0, 0.0, 0.15), 1.0)
    assert state.road_wheel_angle == pytest.approx(HANDS / CAR.steering_ratio)


def test_limits_of_angle_and_rate():
    """0.5 rad/s for the first 0.1 s, 0.15 rad in the end.

    And the angle goes on at its rate without jumps.
    """
    column, spins = Active(hands=0.0), BodyVelocity(10.0, 0.0, -5.0)
    before = column.drive(spins, 0.1)
    assert before.road_wheel_rate == pytest.approx(0.5)
    assert before.road_wheel_angle == pytest.approx(0.05, abs=0.5 * PERIOD * 1.01)
    for _ in range(50):
        state = column.drive(spins, PERIOD)
        gone = before.road_wheel_angle + before.road_wheel_rate * PERIOD
        assert state.road_wheel_angle == pytest.approx(gone, abs=1e-12)
        before = state
    assert before.road_wheel_angle == 0.15


def test_without_gain_it_is_the_steering_robot():
    """Both agree to the bit, whatever the car does."""
    values = {"profile.time": [0.1, 0.6], "profile.angle": [0.0, 3.0]}
    method = find_method("steering_column", "steering_robot")
    robot, active = (
        create(method, build(method.parameters, values), CAR, PERIOD),
        Active(gain=0.0, **values),
    )
    for n in range(100):
        robot.advance(Instant(n * PERIOD))
        assert (active.drive(BodyVelocity(9.0, 0.1, 0.7), PERIOD),) == robot.outputs()
