"""The speed that slip is counted against, by hand.

And that free wheels are asked for where there are some.
"""

from __future__ import annotations

import dataclasses
import math
import os
import subprocess

import pytest
from helpers.traction import METHODS, PERIOD, ROLE, Control, car_of, in_regulator, numbers_of

from ev_control.estimation.plausible import Sensors
from ev_control.estimation.reference_speed import (
    ReferenceSpeedParameters,
    ReferenceSpeedState,
    Source,
    StandstillParameters,
    rolling_speeds,
)
from ev_core.lockstep.configuration import configure
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import InertialMeasurement, SteeringColumnState, WheelStates
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_stack.running.node_process import command
from ev_stack.scenarios.scenario import Overrides, load_scenario

REAR = ("rear_left", "rear_right")
CAR = Vehicle(wheelbase=2.7, front_track=1.5, rear_track=1.6, wheel_radius=0.32)


class Reference:
    """The estimate, interpreted, with its state."""

    def __init__(self, driven: tuple[str, ...], **changed) -> None:
        self._p = numbers_of(ReferenceSpeedParameters(**changed))
        self._car = car_of(dataclasses.replace(CAR, driven_wheels=driven))
        self.state = ReferenceSpeedState()

    def rolling(
        self, velocity: Wheels, angle: float, imu: InertialMeasurement, direction: float
    ) -> Wheels:
        sensors = Sensors(
            SteeringColumnState(0.0, 0.0, 0.0, angle, 0.0),
            WheelStates(NO_WHEELS, velocity, NO_WHEELS),
            imu,
        )
        return rolling_speeds(self._p, self._car, self.state, PERIOD, sensors, direction)


def observer(at: float = 0.0, source: Source = Source.OBSERVER, **changed) -> Reference:
    """An observer that has begun at a speed [m/s], straight on."""
    reference = Reference(WHEEL_NAMES, source=source, **changed)
    reference.rolling(
        Wheels.all(at / CAR.wheel_radius), 0.0, InertialMeasurement(0.0, 0.0, 0.0), 0.0
    )
    assert reference.state.speed == pytest.approx(at, rel=1e-15)
    return reference


def rolling(u: float, r: float, delta: float) -> Wheels:
    """Wheel speeds by the velocity of each contact point [rad/s].

    The rear axle moves straight ahead.
    """
    speeds = []
    for name in WHEEL_NAMES:
        front = name.startswith("front")
        y = (
            (CAR.front_track if front else CAR.rear_track)
            / 2
            * (1 if name.endswith("left") else -1)
        )
        angle = delta if front else 0.0
        along = (u - r * y) * math.cos(angle) + (CAR.wheelbase * r if front else 0.0) * math.sin(
            angle
        )
        speeds.append(along / CAR.wheel_radius)
    return Wheels(*speeds)


@pytest.mark.parametrize("driven", [("front_left", "front_right"), REAR, ("front_left",)])
@pytest.mark.parametrize(
    ("u", "r", "delta"), [(5.0, 0.0, 0.0), (5.0, 0.6, 0.3), (-3.0, 0.4, -0.35), (0.0, 0.0, 0.5)]
)
def test_free_wheels_give_the_rolling_speed_of_every_wheel(driven, u, r, delta):
    """Bend, rest and reverse, whatever the driven wheels do."""
    reference = Reference(driven)
    expected = rolling(u, r, delta)
    spinning = Wheels(
        *(99.0 if name in driven else w for name, w in zip(WHEEL_NAMES, expected, strict=True))
    )
    found = reference.rolling(spinning, delta, InertialMeasurement(r, 0.0, 0.0), 1.0)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert reference.state.speed == pytest.approx(u, abs=1e-12)


@pytest.mark.parametrize(
    ("u", "r", "delta"), [(5.0, 0.0, 0.0), (5.0, 0.6, 0.3), (-3.0, 0.4, -0.35)]
)
def test_observer_of_a_car_that_rolls_shows_how_it_rolls(u, r, delta):
    """All wheels say the same then, so that the estimate is left where it is."""
    reference = observer(at=u)
    expected = rolling(u, r, delta)
    found = reference.rolling(
        expected, delta, InertialMeasurement(r, 0.0, 0.0), math.copysign(1.0, u)
    )
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("source", ["automatic", "observer"])
def test_without_free_wheels_automatic_is_the_observer(source):
    """It goes by the accelerometer, not by the mean of the wheels."""
    reference = observer(source=Source.of(source), slipping_rate=0.0)
    reference.rolling(Wheels.all(40.0), 0.0, InertialMeasurement(0.0, 2.0, 0.0), 1.0)
    assert reference.state.speed == 2.0 * PERIOD


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_observer_follows_the_car_while_all_wheels_spin(ahead):
    """All four wheels spin up at 30 m/s^2, the car at 1.

    After 2 s 2 m/s, and what 0.5 1/s draws it to the wheels.

    The wheels lead by 29 t m/s, so e' = 0.5 (29 t - e): e = 29 (t - 2 (1 - exp(-t/2))) = 21.3 m/s.
    Without the drawing the estimate is exact, so the test takes 0.02 1/s and 1.2 m/s.
    """
    exact, drawn = observer(slipping_rate=0.0), observer(slipping_rate=0.02)
    for n in range(1, 401):
        imu, speed = InertialMeasurement(0.0, ahead, 0.0), ahead * 30.0 * n * PERIOD / 0.32
        for reference in (exact, drawn):
            reference.rolling(Wheels.all(speed), 0.0, imu, ahead)
    assert exact.state.speed == pytest.approx(2.0 * ahead, rel=1e-12)
    excess = 29.0 * (2.0 - 50.0 * (1.0 - math.exp(-0.04)))
    assert drawn.state.speed == pytest.approx((2.0 + excess) * ahead, rel=0.01)


@pytest.mark.parametrize("driven", [WHEEL_NAMES, REAR])
@pytest.mark.parametrize(
    ("u", "r", "delta"), [(22.0, 0.0, 0.0), (8.0, 0.6, 0.3), (-8.0, 0.4, -0.3)]
)
def test_the_first_speed_is_that_of_the_wheels(driven, u, r, delta):
    """A car that begins on the move, or restarts its controller there, has no slip at first."""
    reference = Reference(driven)
    expected = rolling(u, r, delta)
    found = reference.rolling(
        expected, delta, InertialMeasurement(r, 0.0, 0.0), math.copysign(1.0, u)
    )
    assert found == pytest.approx(expected, rel=1e-12)


def test_observer_believes_the_slowest_wheel_at_once():
    """A wheel that rolls at 4 m/s under an estimate of 6.

    The error decays with 20 1/s, to 1.9 % in 0.2 s.
    """
    reference = observer(at=6.0)
    for _ in range(40):
        reference.rolling(
            Wheels(30.0, 30.0, 12.5, 40.0), 0.0, InertialMeasurement(0.0, 0.0, 0.0), 1.0
        )
    assert reference.state.speed == pytest.approx(4.0 + 2.0 * 0.9**40, rel=1e-9)


def test_observer_believes_the_fastest_wheel_when_braking():
    reference = observer(at=3.0)
    for _ in range(40):
        reference.rolling(
            Wheels(0.0, 5.0, 12.5, 0.0), 0.0, InertialMeasurement(0.0, 0.0, 0.0), -1.0
        )
    assert reference.state.speed == pytest.approx(4.0 - 0.9**40, rel=1e-9)


def test_an_offset_of_the_accelerometer_stays_bounded():
    """Speed 10 m/s with an offset of 0.2 m/s^2.

    Too low by at most 0.2/0.5 = 0.4 m/s, too high by 0.2/20 = 0.01 m/s.
    """
    for offset, low, high in ((-0.2, 9.6, 10.0), (0.2, 10.0, 10.01)):
        reference = observer(at=10.0)
        for _ in range(4000):
            reference.rolling(
                Wheels.all(10.0 / 0.32), 0.0, InertialMeasurement(0.0, offset, 0.0), 1.0
            )
        assert low - 1e-3 <= reference.state.speed <= high + 1e-3


def standing(offset: float, seconds: float, speed: float = 0.0, **standstill) -> Reference:
    """An observer begun at a speed [m/s].

    Then the wheels stand, braked, under an offset [m/s^2].
    """
    reference = observer(at=speed, standstill=StandstillParameters(**{"rate": 1.0, **standstill}))
    for _ in range(round(seconds / PERIOD)):
        reference.rolling(Wheels.all(0.0), 0.0, InertialMeasurement(0.0, offset, 0.0), -1.0)
    return reference


@pytest.mark.parametrize("offset", [-0.2, 0.2])
def test_at_rest_the_offset_is_learned_and_moves_the_car_no_more(offset):
    """0.5 s until it stands, then first order with 1/s.

    After 4 s more e^-4 of it is left, 1.8 %, and no speed.

    The steps of PERIOD are an explicit Euler rule: (1 - h)^n for e^-nh, which is 2 % of what is
    left.
    """
    reference = standing(offset, 4.5)
    assert reference.state.speed == 0.0
    assert reference.state.offset == pytest.approx(offset * (1.0 - math.exp(-4.0)), rel=1e-3)
    # a second ahead with wheels that spin far above: by the accelerometer alone
    for _ in range(200):
        reference.rolling(Wheels.all(40.0), 0.0, InertialMeasurement(0.0, 1.0 + offset, 0.0), 1.0)
    assert reference.state.offset == pytest.approx(offset * (1.0 - math.exp(-4.0)), rel=1e-3)


def test_an_offset_beyond_the_largest_is_a_slope_and_not_believed():
    """1 m/s^2 is a hill of 10 % to a car's accelerometer; the car stands all the same."""
    reference = standing(1.0, 10.0)
    assert (reference.state.speed, reference.state.offset) == (0.0, 0.3)


def test_wheels_that_lock_on_the_move_do_not_stand():
    """20 m/s, 3 m/s^2, locked wheels: 17 m/s after 1 s less 0.05 1/s of `slipping_rate`."""
    reference = observer(at=20.0, slipping_rate=0.05, standstill=StandstillParameters(rate=1.0))
    for _ in range(round(1.0 / PERIOD)):
        reference.rolling(Wheels.all(0.0), 0.0, InertialMeasurement(0.0, -3.0, 0.0), -1.0)
    assert reference.state.offset == 0.0
    # -20 m/s of gap at 0.05 1/s take 0.9 m/s in the second; 0.1 m/s is what the falling gap and the steps change.
    assert reference.state.speed == pytest.approx(17.0 - 0.9, abs=0.1)


def test_no_rate_learns_nothing():
    """Default of all traction controls.

    0.2 m/s^2 against 0.5 1/s are 0.4 m/s for a car that stands.
    """
    reference = standing(0.2, 20.0, rate=0.0)
    assert reference.state.offset == 0.0
    assert reference.state.speed == pytest.approx(0.4, rel=0.01)  # e^-10 and the step are below


# Free wheels are refused where there are none, in one line, before anything is made


def refusal(name: str) -> str:
    source = in_regulator(name, "reference.source")
    return (
        f"asr method {name} needs a wheel without a motor for {source} free_wheels, vehicle all_wheels drives "
        "front_left, front_right, rear_left, rear_right"
    )


def free_wheels_of(name: str) -> dict:
    return {
        "method": name,
        in_regulator(name, "reference.source"): "free_wheels",
        "vehicle.name": "all_wheels",
    }


@pytest.mark.parametrize("name", METHODS)
def test_free_wheels_are_refused_by_the_configuration_where_there_are_none(name):
    values = free_wheels_of(name)
    configure(ROLE, values)
    all_driven = {"vehicle.driven_wheels": list(WHEEL_NAMES)}
    with pytest.raises(ParameterError) as error:
        configure(ROLE, {**values, **all_driven})
    assert str(error.value) == refusal(name)
    automatic = {in_regulator(name, "reference.source"): "automatic"}
    accepted = configure(ROLE, {**values, **all_driven, **automatic})
    with pytest.raises(ParameterError) as error:  # a live change is the same question
        accepted.changed({in_regulator(name, "reference.source"): "free_wheels"})
    assert str(error.value) == refusal(name)


@pytest.mark.parametrize("name", ["pi_slip", "least_squares"])
def test_a_run_that_asks_for_them_is_refused_before_it_begins(name):
    values = [
        (ROLE, key, value)
        for key, value in free_wheels_of(name).items()
        if not key.startswith("vehicle.")
    ]
    values += [
        ("*", "vehicle.driven_wheels", list(WHEEL_NAMES)),
        ("*", "vehicle.name", "all_wheels"),
    ]
    with pytest.raises(ParameterError) as error:
        load_scenario("launch_split_mu", Overrides((), values))
    assert refusal(name) in str(error.value)


def test_a_node_that_asks_for_them_ends_with_the_same_line():
    words = [f"{key}:={value}" for key, value in free_wheels_of("pi_slip").items()]
    words.append(f"vehicle.driven_wheels:=[{', '.join(WHEEL_NAMES)}]")
    given = [word for assignment in words for word in ("-p", assignment)]
    ended = subprocess.run(
        [*command(ROLE), "--ros-args", *given],
        capture_output=True,
        text=True,
        env={**os.environ},
        check=False,
    )
    assert ended.returncode == 1
    assert (ended.stdout + ended.stderr).strip().splitlines() == [f"{ROLE}: {refusal('pi_slip')}"]


def test_free_wheels_are_taken_where_there_are_some():
    assert (
        Control("pi_slip", **{"regulator.reference.source": "free_wheels"}).limits()
        == [math.inf] * 4
    )
