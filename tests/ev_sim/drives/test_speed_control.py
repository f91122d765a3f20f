"""The speed control of drives, and the planar plant with drives in speed mode."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.compiled_object import CompiledObject

from ev_core.lockstep.finding import find_method
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import WheelSpeedCommand
from ev_msgs_py.contract.signals import (
    MotorStates,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_sim.drives.synchronous_motor import (
    SpeedControl,
    speed_control,
    speed_control_without_windup,
)

STRAIGHT = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)
PERIOD = 0.01
CAR = Vehicle(gear_ratio=7.4)
CONTROL = SpeedControl(gain=3.0, integral_time=0.1, period=1e-3, least=0.0, most=10.0)
BOTH_WAYS = CONTROL._replace(least=-10.0)
# the PI itself makes 0.07
OVERSHOOTS = (("ice", 0.0, 100.0, 20.0, 0.02), ("dry_asphalt", 0.05, 300.0, 10.0, 0.1))


def test_proportional_and_integral_part_by_hand():
    """K e = 6 and K e h/T = 0.06 on top of an integral of 1 N m.

    Only the integral stays within the torques.
    """
    assert speed_control(CONTROL, 1.0, 2.0) == pytest.approx((7.06, 1.06), rel=1e-12)
    assert speed_control(CONTROL, 9.99, 2.0) == pytest.approx((16.0, 10.0), rel=1e-12)
    assert speed_control(CONTROL, 0.01, -2.0) == pytest.approx((-6.0, 0.0), rel=1e-12)


@pytest.mark.parametrize(("error", "limit"), [(2.0, 10.0), (-2.0, -10.0)])
def test_the_integral_holds_where_the_torque_is_limited(error, limit):
    """It stays at 9 N m where 15 are asked of 10, either way, and goes back with the error."""
    integral = 0.9 * limit
    asked, held = speed_control_without_windup(BOTH_WAYS, integral, error)
    assert (asked, held) == (3.0 * error + integral, integral)
    assert abs(speed_control_without_windup(BOTH_WAYS, integral, -error)[1]) < abs(integral)


def plant(speed_mode: bool = True, **values) -> CompiledObject:
    found = find_method("plant", "planar")
    parameters = build(found.parameters, {"speed_mode": speed_mode, **values})
    return CompiledObject(found.with_options(parameters, CAR), parameters, CAR, PERIOD)


def signals(car: CompiledObject) -> dict[type, tuple]:
    return {type(signal): signal for signal in car.outputs()}


@pytest.mark.slow
def test_drive_reaches_its_set_point_within_the_torque_and_never_pulls_back():
    """A hill of 5 % with at most 300 N m a wheel: 10 rad/s within 0.5 % after 10 s.

    Then 5 rad/s, no torque at once.

    The speed control of these gains has a damping ratio of 0.6 with the car, 2 rad/s of natural
    frequency: 10 s are many times its settling.
    """
    car = plant(**{"road.grade": (0.05,)})
    command = WheelTorqueCommand(Wheels.front(300.0, 300.0), NO_WHEELS)
    torques = []
    for n in range(1050):
        car.advance(command, STRAIGHT, WheelSpeedCommand(Wheels.all(10.0 if n < 1000 else 5.0)))
        outputs = signals(car)
        torques.append(outputs[WheelStates].effort.front_left)
        if n == 999:
            assert outputs[WheelStates].velocity.front_left == pytest.approx(10.0, rel=0.005)
    assert max(torques) == pytest.approx(300.0, rel=1e-3)
    assert min(torques) > -1e-9 and abs(torques[-1]) < 1e-6
    assert outputs[MotorStates].effort.rear_left == 0.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize(("surface", "grade", "torque", "goal", "beyond"), OVERSHOOTS)
def test_an_integral_that_waited_at_the_limit_does_not_overshoot(
    surface, grade, torque, goal, beyond, sense
):
    """The overshoot from rest is that of the PI itself.

    Windup would make 0.27 rad/s on ice and 0.67 on the hill.
    """
    road = {"road.left": (surface,), "road.right": (surface,), "road.grade": (sense * grade,)}
    car = plant(**road)
    command = WheelTorqueCommand(Wheels.front(sense * torque, sense * torque), NO_WHEELS)
    reached = []
    for _ in range(800):
        car.advance(command, STRAIGHT, WheelSpeedCommand(Wheels.all(sense * goal)))
        reached.append(sense * signals(car)[WheelStates].velocity.front_left)
    assert max(reached) < goal + beyond
    assert reached[-1] == pytest.approx(goal, rel=0.005)


def test_a_set_point_that_comes_into_reach_takes_over_without_a_jump():
    """A wheel at its own speed keeps its torque, because the integral follows it beyond reach."""
    car = plant()
    command = WheelTorqueCommand(Wheels.front(250.0, 250.0), NO_WHEELS)
    for _ in range(50):
        car.advance(
            command,
            STRAIGHT,
            WheelSpeedCommand(Wheels.all(CAR.motor.maximum_speed / CAR.gear_ratio)),
        )
    before = signals(car)[WheelStates]
    car.advance(command, STRAIGHT, WheelSpeedCommand(before.velocity))
    after = signals(car)[WheelStates]
    assert after.effort.front_left > 0.8 * before.effort.front_left


@pytest.mark.slow
def test_a_set_point_out_of_reach_is_torque_mode_to_the_bit():
    """Forwards, off the pedal, and generating, which has the set-point behind the car."""
    free, set_ = plant(speed_mode=False), plant()
    fastest = CAR.motor.maximum_speed / CAR.gear_ratio
    for torque in [250.0] * 60 + [0.0] * 20 + [-80.0] * 40:
        command = WheelTorqueCommand(Wheels.front(torque, torque), NO_WHEELS)
        free.advance(command, STRAIGHT)
        set_.advance(
            command, STRAIGHT, WheelSpeedCommand(Wheels.all(fastest if torque >= 0.0 else -fastest))
        )
        assert set_.outputs() == free.outputs()


def test_coupled_wheels_are_refused():
    """One motor behind a differential cannot give each wheel a speed."""
    found = find_method("plant", "planar")
    speed_mode = build(found.parameters, {"speed_mode": True})
    coupled = dataclasses.replace(
        Vehicle(), driveline=dataclasses.replace(Vehicle().driveline, coupling="open")
    )
    (need,) = found.factory.needs
    assert need(speed_mode, coupled) == "driveline.coupling individual"
    assert need(speed_mode, Vehicle()) == need(found.parameters(), coupled) == ""
