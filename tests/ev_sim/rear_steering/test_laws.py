"""The laws of the rear wheels' angle, alone and with the car."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ev_core.lockstep.finding import find_method
from ev_core.vehicle.car import GRAVITY
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, TireForces
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.steering.rear_axle import SpeedDependentParameters
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.analysis.linear_models import single_track

FRONT = 0.05  # rad
ROLLING = TireForces(NO_WHEELS, NO_WHEELS, Wheels.all(3000.0), NO_WHEELS, NO_WHEELS, NO_WHEELS)
CAR = load_scenario("rear_steering").runs[0].configurations["plant"].common.vehicle


def ratio_after_a_while(method: str, speed: float) -> float:
    """Rear over front angle of a car straight on at a speed, with its front wheels turned."""
    found = find_method("rear_steering", method)
    law = found.factory(found.parameters(max_angle=1.0), CAR, 0.01)
    column = SteeringColumnState(FRONT * CAR.steering_ratio, 0.0, 0.0, FRONT, 0.0)
    for _ in range(200):
        law.advance(column, BodyVelocity(speed, 0.0, 0.0), ROLLING)
    return law.outputs()[0].angle / FRONT


@pytest.mark.parametrize(
    ("speed", "ratio"), [(0.0, -0.4), (5.0, -0.3), (15.0, 0.0), (22.5, 0.15), (50.0, 0.3)]
)
def test_speed_dependent_follows_its_points_forwards_and_in_reverse(speed, ratio):
    assert ratio_after_a_while("speed_dependent", speed) == pytest.approx(ratio, abs=1e-5)
    assert ratio_after_a_while("speed_dependent", -speed) == pytest.approx(ratio, abs=1e-5)


@pytest.mark.parametrize("speed", [5.0, 15.0, 25.0, 40.0])
def test_zero_sideslip_is_that_of_the_linear_model(speed):
    """A car with this ratio has no steady lateral velocity in its single-track model."""
    ratio = ratio_after_a_while("zero_sideslip", speed)
    model = single_track(dataclasses.replace(CAR, rear_steering_ratio=ratio), speed)
    lateral, yaw_rate = np.linalg.solve(-model.A, model.B)[:2, 0]
    assert abs(lateral) < 1e-4 * abs(yaw_rate) * CAR.wheelbase
    assert yaw_rate > 0.0


def test_at_standstill_zero_sideslip_turns_about_a_point_beside_the_centre_of_mass():
    rear = CAR.centre_of_mass_to_rear_axle
    assert ratio_after_a_while("zero_sideslip", 0.0) == pytest.approx(
        -rear / (CAR.wheelbase - rear), abs=1e-5
    )


def driven(
    run: str, *values: tuple, scenario: str = "rear_steering", duration: float | None = None
) -> Recording:
    loaded = load_scenario(scenario, Overrides((), values, duration), (run,) if run else ())
    return run_offline(loaded.runs[0].configurations, loaded.runs[0].duration)


def largest_sideslip(recording: Recording) -> float:
    lateral, along = (recording.channels[f"twist.{name}"] for name in ("lateral", "longitudinal"))
    return float(np.abs(np.arctan2(lateral, along)).max())


def test_in_a_lane_change_little_sideslip_is_left():
    """The linear law holds where the tyres are nearly linear and the car nearly steady.

    A third is asked here.
    """
    straight, by_speed, zero = (
        largest_sideslip(driven(run)) for run in ("straight", "speed_dependent", "zero_sideslip")
    )
    assert by_speed < 0.9 * straight
    assert zero < straight / 3


@pytest.mark.parametrize("speed", [8.0, -5.0, -8.0])
def test_zero_sideslip_holds_forwards_and_in_reverse(speed):
    """The lateral velocity in a steady bend is below a twentieth of that of the rear axle, b r."""
    slow = (
        ("plant", "initial_speed", speed),
        ("driver", "speed_profile.speed", [speed]),
        ("*", "vehicle.mass", 1600.0),
    )
    steered = (("rear_steering", "method", "zero_sideslip"), ("steering_column", "scale", 0.1))
    run = driven(
        "left",
        *slow,
        *steered,
        scenario="step_steer",
        duration=8.0,
    )
    lateral, yaw_rate = (abs(run.channels[f"twist.{name}"][-1]) for name in ("lateral", "yaw_rate"))
    assert yaw_rate > 0.001
    assert lateral < 0.05 * CAR.centre_of_mass_to_rear_axle * yaw_rate


def test_wheels_are_turned_by_the_side_force_and_the_motor_works_against_it():
    """Straight wheels have the servo's error alone, below a milliradian.

    It takes watts, not kilowatts.
    """
    channels = driven("straight").channels
    assert 1e-5 < np.abs(channels["rear_steering.state.angle"]).max() < 1e-3
    assert 0.1 < channels["rear_steering.state.power"].max() < 100.0


def test_without_trail_straight_wheels_are_those_of_the_plain_plant():
    """Nothing turns them then: the signals of both plants are the same to the bit."""
    plain = driven("", ("*", "vehicle.mass", CAR.mass), scenario="double_lane_change", duration=4.0)
    apart = driven(
        "",
        ("*", "vehicle.mass", CAR.mass),
        ("rear_steering", "method", "speed_dependent"),
        ("rear_steering", "ratio", [0.0, 0.0, 0.0, 0.0]),
        ("rear_steering", "trail", 0.0),
        scenario="double_lane_change",
        duration=4.0,
    )
    assert {*apart.channels} - {*plain.channels} == {
        f"rear_steering.state.{name}"
        for name in ("angle", "rate", "motor_speed", "motor_torque", "power")
    }
    for name, values in plain.channels.items():
        assert apart.channels[name].tobytes() == values.tobytes(), name


def test_opposite_wheels_turn_a_slow_car_on_a_smaller_circle():
    """R = L/(tan d_f - tan d_r) without slip angles; at 2 m/s they are below 0.1 degree."""
    turned = [
        ("steering_column", "method", "steering_robot"),
        ("steering_column", "profile.angle", [2.0]),
    ]
    slow = [("plant", "initial_speed", 2.0), ("driver", "speed_profile.speed", [2.0])]
    radii = {}
    for run in ("straight", "speed_dependent"):
        channels = driven(run, *turned, *slow).channels
        radii[run] = channels["twist.longitudinal"][-1] / channels["imu.yaw_rate"][-1]
        front, rear = (
            channels[f"{name}.state.{of}"][-1]
            for name, of in (("steering_column", "road_wheel_angle"), ("rear_steering", "angle"))
        )
        assert radii[run] == pytest.approx(CAR.wheelbase / (np.tan(front) - np.tan(rear)), rel=0.02)
    assert radii["speed_dependent"] < 0.8 * radii["straight"]


def test_a_left_turn_mirrors_a_right_one():
    right, left = (
        driven(
            "speed_dependent",
            ("steering_column", "method", "steering_robot"),
            ("steering_column", "profile.angle", [angle]),
            duration=2.0,
        ).channels
        for angle in (-0.5, 0.5)
    )
    for name in ("imu.yaw_rate", "rear_steering.state.angle", "rear_steering.state.motor_torque"):
        assert (right[name] == -left[name]).all()
        assert np.abs(left[name]).max() > 0.0


@pytest.mark.parametrize(
    ("speed", "ratio", "named"),
    [
        ((0.0, 10.0), (0.0,), "2 and 1 elements"),
        ((10.0, 5.0), (0.0, 0.1), "5 m/s after 10 m/s"),
        ((), (), "0 and 0"),
    ],
)
def test_points_that_are_none_are_refused(speed, ratio, named):
    with pytest.raises(ParameterError, match=named):
        SpeedDependentParameters(speed=speed, ratio=ratio)


def test_a_plant_that_turns_no_rear_wheels_is_refused_in_one_line():
    steered = ("rear_steering", "method", "zero_sideslip")
    off = ("plant", "rear_steering", False)
    with pytest.raises(ParameterError, match=r"requires plant\.rear_steering true, but false is"):
        load_scenario("double_lane_change", Overrides((), [steered, off]))


def test_a_plant_whose_rear_wheels_nothing_steers_is_refused_in_one_line():
    alone = Overrides((), [("plant", "rear_steering", True)])
    with pytest.raises(ParameterError, match="reads RearSteeringState, which none"):
        load_scenario("double_lane_change", alone)


def test_side_force_of_the_road_is_within_what_the_motor_carries():
    """3 N m behind 400 carry 1200 N m.

    The load of the rear axle at full grip and 3 cm of trail give 150 N m.
    """
    rear_load = CAR.mass * GRAVITY * (1.0 - CAR.centre_of_mass_to_rear_axle / CAR.wheelbase)
    p = SpeedDependentParameters()
    assert p.trail * rear_load < p.peak_torque * p.gear_ratio / 5
