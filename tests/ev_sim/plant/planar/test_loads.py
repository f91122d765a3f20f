"""Wheel loads and steering geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from plant.planar.car import STRAIGHT, command, outputs, plant

from ev_core.methods.law import namespace
from ev_core.vehicle.car import Car, car_numbers
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import TireForces
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.body import front_wheels, wheel_loads

NORMAL = 2500.0 * 9.81
GE_NI = {
    "centre_of_mass_to_rear_axle": 0.82,
    "wheelbase": 1.72,
    "front_track": 1.12,
    "rear_track": 1.12,
}
SQUARE = {
    "centre_of_mass_to_rear_axle": 1.0,
    "wheelbase": 2.0,
    "front_track": 1.5,
    "rear_track": 1.5,
}


def numbers_of(**values) -> Car:
    """A car as laws see it."""
    return namespace(car_numbers(Vehicle(**values)))


def shared(front: float, moment: float) -> tuple[float, float]:
    """Roll moments of front and rear axle [N m], of which the front one takes a share [1]."""
    return front * moment, (1.0 - front) * moment


def test_lateral_transfer_of_ge_and_ni():
    """N_1,2 = b/(2L) (m g -+ 2 h F_c/B), N_3,4 with a for b, the left wheels inside."""
    moment = 0.6 * 2500.0 * 2.0
    loads = wheel_loads(numbers_of(**GE_NI), NORMAL, 0.0, shared(0.82 / 1.72, moment))
    front, rear = 0.82 / (2 * 1.72), 0.90 / (2 * 1.72)
    left, right = NORMAL - 2 * moment / 1.12, NORMAL + 2 * moment / 1.12
    assert loads == pytest.approx((front * left, front * right, rear * left, rear * right))


def test_centre_of_mass_off_the_middle():
    """The left wheels carry 1/2 + offset/track of their axle."""
    loads = wheel_loads(numbers_of(**SQUARE, centre_of_mass_offset=0.15), 1000.0, 0.0, (0.0, 0.0))
    assert loads == pytest.approx((300.0, 200.0, 300.0, 200.0))


def test_what_a_lifted_wheel_cannot_take_goes_to_the_other_axle():
    """The front axle takes all of a roll moment until its inner wheel lifts.

    Moment balance holds nevertheless.
    """
    loads = wheel_loads(numbers_of(**SQUARE), 1000.0, 0.0, shared(1.0, 500.0))
    assert loads[0] == 0.0
    assert 0.75 * ((loads[1] - loads[0]) + (loads[3] - loads[2])) == pytest.approx(500.0)


@given(
    st.floats(-3e4, 3e4), st.floats(-5e4, 5e4), st.floats(0.0, 1.72), st.floats(-0.5, 0.5), st.floats(0.0, 1.0)
)  # fmt: skip
def test_loads_are_never_negative_and_always_carry_the_car(pitch, roll, rear_arm, offset, share):
    layout = {**GE_NI, "centre_of_mass_to_rear_axle": rear_arm, "centre_of_mass_offset": offset}
    loads = wheel_loads(numbers_of(**layout), NORMAL, pitch, shared(share, roll))
    assert min(loads) >= 0.0
    assert sum(loads) == pytest.approx(NORMAL)


def test_lifted_wheels_are_reported():
    """A tall narrow car on a side slope of 45 %: its right wheels carry it."""
    tall = Vehicle(centre_of_mass_height=2.0)
    car = plant(tall, road__side_slope=(0.45,))
    for _ in range(100):
        car.advance(command(brake=(2000.0,) * 4), STRAIGHT)
    loads = outputs(car)[TireForces].load
    assert loads.front_left == loads.rear_left == 0.0
    assert car.reports() == ("front_left wheel left the ground", "rear_left wheel left the ground")
    assert np.isfinite(car.state).all()


@pytest.mark.parametrize("angle", [0.0, 0.2, -0.2, 0.5])
def test_ackermann(angle):
    """The axes of both front wheels meet on the rear axle (Shchur, eq 8)."""
    cos_left, sin_left, cos_right, sin_right = front_wheels(numbers_of(), angle)
    assert math.hypot(cos_left, sin_left) == pytest.approx(1.0)
    if angle == 0.0:
        assert sin_left == sin_right == 0.0
        return
    middle = 2.405 / math.tan(angle)
    assert 2.405 * cos_left / sin_left == pytest.approx(middle - 0.731)
    assert 2.405 * cos_right / sin_right == pytest.approx(middle + 0.731)
    parallel = front_wheels(numbers_of(steering_geometry="parallel"), angle)
    assert parallel[1] == parallel[3]


@given(base=st.floats(0.3, 12.0), track=st.floats(0.2, 4.0), angle=st.floats(0.01, 1.4))
def test_no_front_wheel_of_an_accepted_car_turns_over(base, track, angle):
    """Cars with a turn's centre between the wheels are refused: eq 8 turns one by 180 deg."""
    car = {
        "wheelbase": base,
        "centre_of_mass_to_rear_axle": base / 2.0,
        "front_track": track,
        "rear_track": track,
    }
    across = 0.5 * track * math.tan(angle) / base
    assume(abs(across - 1.0) > 1e-9)
    if across > 1.0:
        with pytest.raises(
            ParameterError, match=r"^maximum_road_wheel_angle: .* is refused, expected below"
        ):
            numbers_of(maximum_road_wheel_angle=angle, **car)
        return
    _, left, _, right = front_wheels(numbers_of(maximum_road_wheel_angle=angle, **car), angle)
    assert 0.0 < right < left
