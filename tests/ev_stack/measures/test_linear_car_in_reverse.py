"""The steady linear car in reverse.

What metrics, drivers and laws reckon with is what the planar plant does.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import ev_stack
from ev_control.electronic_differential.steering_by_drives import (
    Against,
    CourseStabilityParameters,
    Wish,
    yaw_moment,
)
from ev_control.shared.blended_wheel import YawDifferenceParameters, yaw_error
from ev_core.vehicle.car import turning_length
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import InertialMeasurement, SteeringColumnState
from ev_sim.driver.preview_driver import steady_circle
from ev_sim.understeer import understeer_gradient
from ev_stack.measures import handling
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.files import vehicle_of

CARS = ("ge_ni2005", "compact_ev")  # tyres alone, and with compliance steer of both axles
SPEEDS = (10.0, -10.0, -5.0)
SIDES = ("left", "right")
# The plant has a lag, load transfer and drag beside the linear car: 0.4 % at 0.3 m/s^2, where K_us
# is worth 15 %.
CLOSE = 0.005


@cache
def settled(car: str, speed: float, side: str) -> Recording:
    """The last two seconds of a small step of the steering wheel."""
    values = {
        "plant.initial_speed": speed,
        "driver.speed_profile.speed": [speed],
        "driver.speed_profile.time": [0.0],
        "steering_column.scale": 0.2,
    }
    return (
        ev_stack.run("step_steer", runs=[side], vehicle=car, duration=12.0, set=values)
        .runs[side]
        .part(1000)
    )


def motion(run: Recording) -> tuple[float, float, float, float]:
    """Road-wheel angle [rad], speed ahead and aside [m/s], and yaw rate [rad/s] in the end."""
    names = (
        "steering_column.state.road_wheel_angle",
        "twist.longitudinal",
        "twist.lateral",
        "imu.yaw_rate",
    )
    return tuple(float(run.channels[name][-1]) for name in names)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("car", CARS)
def test_the_reference_of_the_metric_is_what_the_plant_does(car, speed, side):
    """A reversing car that understeers forwards turns more than a neutral one.

    Compliance steer stays as it is.
    """
    run, vehicle = settled(car, speed, side), vehicle_of(car)
    angle, u, _, yaw_rate = motion(run)
    gradient = understeer_gradient(vehicle, ahead=np.copysign(1.0, speed))
    assert yaw_rate == pytest.approx(
        u * angle / (vehicle.wheelbase + gradient * u * abs(u)), rel=CLOSE
    )
    assert handling.yaw_rate_error(run, vehicle) < CLOSE * abs(yaw_rate)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("car", CARS)
def test_the_driver_with_preview_knows_the_steady_circle(car, speed):
    """Angle and sideslip that he learns are those beyond the linear car.

    Here there is nothing to learn.
    """
    angle, u, aside, yaw_rate = motion(settled(car, speed, "left"))
    circle = steady_circle(vehicle_of(car), np.copysign(1.0, speed))
    assert angle == pytest.approx(
        (circle.length / u + circle.gradient * abs(u)) * yaw_rate, rel=CLOSE
    )
    assert aside == pytest.approx((circle.arm - circle.lag * abs(u) * u) * yaw_rate, rel=2 * CLOSE)


@pytest.mark.parametrize("speed", SPEEDS)
def test_laws_want_of_a_steady_car_what_it_does(speed):
    """Laws need the gradient of the tyres only, without compliance steer."""
    car: Vehicle = vehicle_of("ge_ni2005")
    angle, u, _, yaw_rate = motion(settled(car.name, speed, "left"))
    gradient = understeer_gradient(car)
    imu = InertialMeasurement(
        yaw_rate=yaw_rate, longitudinal_acceleration=0.0, lateral_acceleration=u * yaw_rate
    )
    blended = YawDifferenceParameters(understeer=gradient, deadband=0.0)
    assert abs(yaw_error(blended, car, u, angle, imu)) < CLOSE * abs(yaw_rate)
    course = CourseStabilityParameters(
        understeer=gradient, wish=Wish.ANGLE, against=Against.BOTH, yaw_gain=1.0
    )
    column = SteeringColumnState(0.0, 0.0, 0.0, angle, 0.0)
    assert abs(yaw_moment(course, car, 1.0, column, u, yaw_rate)) < CLOSE * abs(yaw_rate)


def test_beyond_its_critical_speed_the_linear_car_has_no_steady_turn():
    """The length is that of L + K u|u| up to a tenth of L, and does not change its sign.

    Forwards it only grows.
    """
    lengths = [turning_length(2.5, 0.002, u) for u in np.linspace(-100.0, 100.0, 201)]
    assert min(lengths) == pytest.approx(0.25)
    assert lengths == sorted(lengths)
    assert turning_length(2.5, 0.002, -10.0) == pytest.approx(2.3)
    assert turning_length(2.5, -0.002, 100.0) == pytest.approx(0.25)
