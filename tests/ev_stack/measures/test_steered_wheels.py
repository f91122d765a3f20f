"""Directions of wheels: slip angles of cars with compliance, gradients of any car."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.lockstep.configuration import configure
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.plant.planar.given import wheel_places
from ev_stack.measures.handling import measured_understeer_gradient, slip_powers, wheel_directions
from ev_stack.measures.named import driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, load_scenario


@pytest.mark.parametrize("direction", [1.0, -1.0], ids=["forwards", "reverse"])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
@pytest.mark.parametrize(("front", "rear"), [(0.0, 0.0), (2.5e-6, 0.0), (2.5e-6, 2e-6)])
def test_wheels_point_where_their_side_force_bends_them(front, rear, side, direction):
    """The ground passes under each wheel at the plant's slip angle on a steady circle.

    To 0.02 deg: the car still loses speed. Without compliance the front wheels would be off by
    2.5e-6 rad/N of 2 kN, 0.3 deg.
    """
    values = [
        ("*", "vehicle.suspension.front_compliance_steer", front),
        ("*", "vehicle.suspension.rear_compliance_steer", rear),
    ]
    scenario = load_scenario(
        "steady_circle", Overrides(vehicle="compact_ev", values=values), ("linear",)
    )
    configurations = scenario.runs[0].configurations
    turned = configure("steering_column", {
        "method": "steering_robot", "profile.time": [0.2, 1.5], "profile.angle": [0.0, 0.9 * side]
    })  # fmt: skip
    run = {
        **configurations,
        "plant": configurations["plant"].changed({"initial_speed": 12.0 * direction}),
        "driver": configurations["driver"].changed(
            {"speed_profile.time": [0.0], "speed_profile.speed": [12.0 * direction]}
        ),
        "steering_column": replace(turned, common=configurations["plant"].common),
    }
    signals, vehicle, *_ = driven_run(run_offline(run, 4.0), run)
    along, across, turning = (
        signals.channels[f"twist.{name}"] for name in ("longitudinal", "lateral", "yaw_rate")
    )
    held = sum(
        signals.channels[f"tire_forces.lateral_force.front_{side}"][-1]
        for side in ("left", "right")
    )
    assert abs(held) > 2000.0
    for wheel, x, y in zip(WHEEL_NAMES, *wheel_places(vehicle), strict=True):
        cosine, sine = wheel_directions(signals, vehicle)[wheel]
        ground_x, ground_y = along - y * turning, across + x * turning
        rolls, slides = ground_x * cosine + ground_y * sine, ground_y * cosine - ground_x * sine
        angle = np.arctan2(slides, np.abs(rolls))[-1]
        assert angle == pytest.approx(
            signals.channels[f"tire_forces.slip_angle.{wheel}"][-1], abs=3.5e-4
        )
        assert slip_powers(signals, vehicle, wheel)[1][-1] > 0.0  # a tyre takes work, it gives none


@pytest.mark.parametrize("direction", [1.0, -1.0], ids=["forwards", "reverse"])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
def test_wheels_at_their_stop_point_there_however_far_the_column_is_turned(side, direction):
    """The column goes on to 0.129 rad of the road wheels, these stop at 0.05 rad.

    Each tyre takes work then, and gives none; with the angle of the column the front ones would
    push the car. The largest angle is that of the wheels, and the yaw rate that of a car so
    steered: by the angle of the column it would be off by 0.3 rad/s.
    """
    values = [("*", "vehicle.maximum_road_wheel_angle", 0.05)]
    scenario = load_scenario(
        "steady_circle", Overrides(vehicle="compact_ev", values=values), ("linear",)
    )
    configurations = scenario.runs[0].configurations
    turned = configure("steering_column", {
        "method": "steering_robot", "profile.time": [0.2, 1.5], "profile.angle": [0.0, 2.0 * side]
    })  # fmt: skip
    run = {
        **configurations,
        "plant": configurations["plant"].changed({"initial_speed": 12.0 * direction}),
        "driver": configurations["driver"].changed(
            {"speed_profile.time": [0.0], "speed_profile.speed": [12.0 * direction]}
        ),
        "steering_column": replace(turned, common=configurations["plant"].common),
    }
    driven = driven_run(run_offline(run, 4.0), run)
    asked = driven.signals.channels["steering_column.state.road_wheel_angle"]
    assert abs(asked[-1]) == pytest.approx(2.0 / driven.vehicle.steering_ratio)
    assert METRICS["maximum_road_wheel_angle"].measured(driven).value == 0.05
    for wheel in WHEEL_NAMES:
        assert slip_powers(driven.signals, driven.vehicle, wheel)[1].min() > -1.0  # [W], rounding
    assert METRICS["slip_energy"].measured(driven).value > 0.0
    assert METRICS["yaw_rate_error"].measured(driven).value < 0.05


@given(
    speed=st.floats(15.0, 50.0),
    gradient=st.floats(-0.004, 0.004),
    side=st.sampled_from([1.0, -1.0]),
    direction=st.sampled_from([1.0, -1.0]),
    ratio=st.floats(-0.3, 0.3),
)
def test_the_gradient_is_that_of_the_car_also_where_it_is_steered_against_the_bend(
    speed, gradient, side, direction, ratio
):
    """The angle between front and rear wheels is L/R + K a_y on a slow ramp.

    Beyond the critical speed of an oversteering car, sqrt(-L/K), it is below zero.
    """
    time = np.arange(0.0, 50.0, 0.02)
    acceleration, none = side * 0.1 * time, np.zeros(len(time))
    car = Vehicle(rear_steering_ratio=ratio)
    turned = (car.wheelbase / speed**2 + gradient) * acceleration
    ramp = Recording(time, {
        "twist.longitudinal": direction * speed + none, "twist.lateral": none,
        "imu.yaw_rate": direction * acceleration / speed,
        "imu.lateral_acceleration": acceleration, "imu.longitudinal_acceleration": none,
        "steering_column.state.road_wheel_angle": turned / (1.0 - ratio),
    })  # fmt: skip
    assert measured_understeer_gradient(ramp, car) == pytest.approx(gradient, abs=1e-9)
