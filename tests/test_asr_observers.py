"""Reference speed and slip observers of the traction controls, by hand and against the truth of the plant."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import pytest

from ev_control.asr.slip_observers import SlipObserver, SlipObserverParameters, SlipObserverState
from ev_control.asr.traction_control import WheelMotion
from ev_control.reference_speed import ReferenceSpeed, ReferenceSpeedParameters
from ev_msgs_py.signals import InertialMeasurement
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels
from ev_sim.scenario.offline import run_offline
from ev_sim.scenario.scenario import Overrides, load_scenario

PERIOD = 0.005
REAR = ("rear_left", "rear_right")
CAR = Vehicle(wheelbase=2.7, front_track=1.5, rear_track=1.6, wheel_radius=0.32)


def rolling(u: float, r: float, delta: float, car: Vehicle = CAR) -> Wheels:
    """Wheel speeds of a car whose rear axle moves straight ahead, by the velocity of each contact point [rad/s]."""
    speeds = []
    for name in WHEEL_NAMES:
        front = name.startswith("front")
        y = (car.front_track if front else car.rear_track) / 2 * (1 if name.endswith("left") else -1)
        angle = delta if front else 0.0
        along = (u - r * y) * math.cos(angle) + (car.wheelbase * r if front else 0.0) * math.sin(angle)
        speeds.append(along / car.wheel_radius)
    return Wheels(*speeds)


@pytest.mark.parametrize("driven", [("front_left", "front_right"), REAR, ("front_left",)])
@pytest.mark.parametrize(("u", "r", "delta"), [(5.0, 0.0, 0.0), (5.0, 0.6, 0.3), (-3.0, 0.4, -0.35), (0.0, 0.0, 0.5)])
def test_free_wheels_give_the_rolling_speed_of_every_wheel(driven, u, r, delta):
    """In a bend, at rest and in reverse; whatever the driven wheels do."""
    reference = ReferenceSpeed(
        ReferenceSpeedParameters(), dataclasses.replace(CAR, driven_wheels=driven), PERIOD, "law"
    )
    expected = rolling(u, r, delta)
    spinning = Wheels(*(99.0 if name in driven else w for name, w in zip(WHEEL_NAMES, expected, strict=True)))
    found = reference.rolling_speeds(spinning, delta, InertialMeasurement(r, 0.0, 0.0), 1.0)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert reference.state.speed == pytest.approx(u, abs=1e-12)


def observer(**changed) -> ReferenceSpeed:
    parameters = ReferenceSpeedParameters(source="observer", **changed)
    return ReferenceSpeed(parameters, dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES), PERIOD, "law")


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_observer_follows_the_car_while_all_wheels_spin(ahead):
    """All four wheels spin up at 30 m/s^2, the car at 1: after 2 s 2 m/s, and what 0.5 1/s draws it to the wheels.

    The wheels lead by 29 t m/s, so e' = 0.5 (29 t - e): e = 29 (t - 2 (1 - exp(-t/2))) = 21.3 m/s. Without the
    drawing the estimate is exact, so the test takes 0.02 1/s and 1.2 m/s.
    """
    exact, drawn = observer(slipping_rate=0.0), observer(slipping_rate=0.02)
    for n in range(1, 401):
        imu, speed = InertialMeasurement(0.0, ahead, 0.0), ahead * 30.0 * n * PERIOD / 0.32
        for reference in (exact, drawn):
            reference.rolling_speeds(Wheels.all(speed), 0.0, imu, ahead)
    assert exact.state.speed == pytest.approx(2.0 * ahead, rel=1e-12)
    excess = 29.0 * (2.0 - 50.0 * (1.0 - math.exp(-0.04)))
    assert drawn.state.speed == pytest.approx((2.0 + excess) * ahead, rel=0.01)


def test_observer_believes_the_slowest_wheel_at_once():
    """A wheel that rolls at 4 m/s under an estimate of 6: the error decays with 20 1/s, to 1.9 % in 0.2 s."""
    reference = observer()
    reference.state.speed = 6.0
    for _ in range(40):
        reference.rolling_speeds(Wheels(30.0, 30.0, 12.5, 40.0), 0.0, InertialMeasurement(0.0, 0.0, 0.0), 1.0)
    assert reference.state.speed == pytest.approx(4.0 + 2.0 * 0.9**40, rel=1e-9)


def test_observer_believes_the_fastest_wheel_when_braking():
    reference = observer()
    reference.state.speed = 3.0
    for _ in range(40):
        reference.rolling_speeds(Wheels(0.0, 5.0, 12.5, 0.0), 0.0, InertialMeasurement(0.0, 0.0, 0.0), -1.0)
    assert reference.state.speed == pytest.approx(4.0 - 0.9**40, rel=1e-9)


def test_an_offset_of_the_accelerometer_stays_bounded():
    """At 10 m/s with an offset of 0.2 m/s^2: too low by at most 0.2/0.5 = 0.4 m/s, too high by 0.2/20 = 0.01 m/s."""
    for offset, low, high in ((-0.2, 9.6, 10.0), (0.2, 10.0, 10.01)):
        reference = observer()
        reference.state.speed = 10.0
        for _ in range(4000):
            imu = InertialMeasurement(0.0, offset, 0.0)
            reference.rolling_speeds(Wheels.all(10.0 / 0.32), 0.0, imu, 1.0)
        assert low - 1e-3 <= reference.state.speed <= high + 1e-3


# Slip observers (eqs 1.8 to 1.10)


@cache
def launched(torque: float) -> tuple[dict[str, np.ndarray], Vehicle]:
    """A launch on dry asphalt without noise and without rolling resistance, which eqs 1.8 to 1.10 do not know."""
    values = [
        ("*", "control_period", PERIOD),
        ("*", "vehicle.rolling_resistance", 0.0),
        ("*", "vehicle.drag_coefficient", 0.0),
        ("plant", "road.left", ["dry_asphalt"]),
        ("plant", "road.right", ["dry_asphalt"]),
        ("driver", "pedals.time", [0.0, 0.5, 2.5]),
        ("driver", "pedals.drive_torque", [0.0, 0.0, torque]),
        ("driver", "pedals.brake_torque", [0.0, 0.0, 0.0]),
        ("asr", "method", "pi_slip"),
        ("asr", "regulator.target", 0.2),
    ]
    run = load_scenario("launch_split_mu", Overrides((), values, 5.0)).runs[0]
    return run_offline(run.configurations, run.duration).channels, run.configurations["asr"].common.vehicle


def observed(kind: str, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Estimated slip and that of the kinematics, of the front left wheel while it turns faster than 3 rad/s."""
    c, car = launched(3600.0)
    slip_observer, state = SlipObserver(SlipObserverParameters(observer=kind), car, PERIOD), SlipObserverState()
    speed = c["wheel_states.velocity.front_left"] + noise * np.random.default_rng(1).standard_normal(
        len(c["twist.longitudinal"])
    )
    free = c["wheel_states.velocity.rear_left"]
    torque, a_x = c["wheel_states.effort.front_left"], c["imu.longitudinal_acceleration"]
    acceleration = np.diff(speed, prepend=speed[0]) / PERIOD
    found = [
        slip_observer.slip(state, WheelMotion(*numbers, 0.0, 0.0, 0))
        for numbers in zip(*(x.tolist() for x in (speed, free, acceleration, torque, a_x)), strict=True)
    ]
    true = 1 - free / np.maximum(speed, 3.0)
    fast = speed > 3.0
    return np.array(found)[fast], true[fast]


@pytest.mark.parametrize(
    ("kind", "noise", "largest", "mean"),
    [
        ("reference_speed", 0.0, 1e-12, 1e-12),
        ("derivative", 0.0, 0.02, 0.015),
        ("derivative", 0.03, 0.04, 0.015),
        ("corrected_derivative", 0.0, 0.01, 0.005),
        ("corrected_derivative", 0.03, 0.03, 0.015),
        ("disturbance", 0.0, 0.35, 0.04),
    ],
)
def test_observers_follow_the_slip(kind, noise, largest, mean):
    """The slip rises to 0.2. Without noise eq 1.8 is 1.3 % too low: it forgets the inertia of the free wheels.

    2 1.658/0.32^2 = 32 of 2170 kg. The noise, integrated, does not pile up. Eq 1.10 is far off while the slip changes.
    """
    found, true = observed(kind, noise)
    error = np.abs(found - true)
    assert true.max() > 0.19
    assert error.max() <= largest
    assert error.mean() <= mean


@pytest.mark.parametrize(
    ("kind", "low", "high"),
    [("derivative", 0.3, 0.6), ("corrected_derivative", 0.07, 0.12), ("disturbance", 0.0, 1.0)],
)
def test_pi_control_on_observers(kind, low, high):
    """Target 0.1 on packed snow, where the resistance that eqs 1.8 and 1.10 do not know is a fifth of the force.

    Eq 1.8 takes it for acceleration of the car and underrates the slip by 0.4; the accelerometer of eq 1.9 does not.
    With eq 1.10, which divides by noise, the car drives off at a fifth of the acceleration; no more can be said.
    """
    values = [
        ("*", "control_period", PERIOD),
        ("plant", "road.left", ["packed_snow_1"]),
        ("plant", "road.right", ["packed_snow_1"]),
        ("plant", "sensors.wheel_speed.noise", 0.03),
        ("driver", "pedals.time", [0.0, 0.5, 1.5]),
        ("driver", "pedals.drive_torque", [0.0, 0.0, 3000.0]),
        ("driver", "pedals.brake_torque", [0.0, 0.0, 0.0]),
        ("asr", "method", "pi_slip"),
        ("asr", "regulator.slip.observer", kind),
    ]
    run = load_scenario("launch_split_mu", Overrides((), values, 6.0)).runs[0]
    channels = run_offline(run.configurations, run.duration).channels
    assert low <= channels["tire_forces.slip_ratio.front_left"][400:].mean() <= high
    assert channels["twist.longitudinal"][-1] > 1.0
