"""Linear models of the steering car against independent derivations."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.vehicle import Tyre, Vehicle
from ev_sim.analysis.side_slip_model import SideSlipModel
from ev_sim.analysis.understeer import axle_cornering_stiffnesses, characteristic_speed, understeer_gradient

CAR = SideSlipModel(wheelbase=2.7, mass=2400.0, yaw_inertia=4200.0, axle_cornering_stiffness=120e3, speed=7.0)
GE_NI = Vehicle(
    mass=2500.0,
    wheelbase=1.72,
    centre_of_mass_to_rear_axle=0.82,
    tyre=Tyre(
        combined="uncoupled",
        lateral_curve="linear",
        front_cornering_stiffness=10500.0,
        rear_cornering_stiffness=12000.0,
    ),
)


def slip_angle_rates(car: SideSlipModel, d1: float, d2: float, theta: float, moment: float) -> np.ndarray:
    """d1', d2' [rad/s] from force and moment balance of v and r at a held steering angle: none of the model's terms."""
    half, speed = car.wheelbase / 2, car.speed
    v, r = speed * ((theta - d1) - d2) / 2, speed * ((theta - d1) + d2) / car.wheelbase
    front = car.axle_cornering_stiffness * d1 + car.front_share * car.drive_force * theta
    rear = car.axle_cornering_stiffness * d2
    v_rate = (front + rear) / car.mass - speed * r
    r_rate = (half * front - half * rear - moment) / car.yaw_inertia
    growth = car.longitudinal_acceleration / speed**2
    return np.array(
        [
            -(v_rate + half * r_rate) / speed + (v + half * r) * growth,
            -(v_rate - half * r_rate) / speed + (v - half * r) * growth,
        ]
    )


cars = st.builds(
    SideSlipModel,
    wheelbase=st.floats(1.5, 4.0),
    mass=st.floats(800.0, 3000.0),
    yaw_inertia=st.floats(500.0, 6000.0),
    axle_cornering_stiffness=st.floats(2e4, 3e5),
    speed=st.floats(3.0, 40.0),
    longitudinal_acceleration=st.floats(-5.0, 5.0),
    drive_force=st.floats(100.0, 4000.0),
    front_share=st.floats(0.0, 0.5),
    rear_difference=st.floats(0.0, 0.6),
    yaw_rate=st.floats(0.05, 1.0),
)
angles = st.floats(-0.1, 0.1)


@settings(deadline=None)
@given(car=cars, d1=angles, d2=angles, theta=angles)
def test_model_is_newton_euler(car, d1, d2, theta):
    """Eqs 1 and 2 with M_z = m_z J_z r against the turn: to 1e-9 of the largest rate that a term may have."""
    system = car.state_space()
    yaw_rate = car.speed / car.wheelbase * (theta + d2 - d1)
    expected = slip_angle_rates(car, d1, d2, theta, car.moment_rate * car.yaw_inertia * yaw_rate)
    rates = system.A @ (d1, d2) + system.B[:, 0] * theta
    assert rates == pytest.approx(expected, rel=1e-9, abs=1e-9 * 0.1 * abs(system.A).max())
    difference = -car.damping * (d2 - d1) + car.excitation * theta
    assert difference == pytest.approx(expected[1] - expected[0], rel=1e-9, abs=1e-9 * 0.1 * abs(system.A).max())


@settings(deadline=None, max_examples=30)
@given(car=cars, frequency=st.floats(0.1, 100.0))
def test_transfer_function_is_that_of_both_slip_angles(car, frequency):
    """W12 from the matrices of eqs 1 and 2 at one frequency, to 1e-9 of their own size."""
    system = car.state_space()
    response = np.linalg.solve(1j * frequency * np.eye(2) - system.A, system.B[:, 0])
    _, w12 = car.transfer_function().freqresp([frequency])
    assert abs(w12[0] - (response[1] - response[0])) < 1e-9 * (1 + abs(response).max())
    assert car.magnitude(np.array([frequency]))[0] == pytest.approx(abs(w12[0]), rel=1e-12)


def test_neutral_front_share():
    """X = 2400 N drives 2400 kg with 1 m/s^2: h = 2 J_z/(m L^2) = 0.480, where W12 vanishes."""
    driven = dataclasses.replace(CAR, drive_force=2400.0, longitudinal_acceleration=1.0)
    neutral = dataclasses.replace(driven, front_share=driven.neutral_front_share)
    assert neutral.front_share == pytest.approx(2 * 4200 / (2400 * 2.7**2), rel=1e-14)
    assert neutral.magnitude(np.array([0.0, 1.0, 10.0])) == pytest.approx(0.0, abs=1e-15)
    assert driven.excitation < 0.0 < dataclasses.replace(driven, front_share=0.5).excitation


def test_neutral_rear_difference_is_the_law_for_the_rear_wheels():
    """At j = 0 and r = V Theta/L, eq 7 gives q = L Theta h/(2 B (1 - h)), the law of axle_redistribution."""
    theta, h = 0.1, 0.4
    car = dataclasses.replace(CAR, drive_force=3000.0, front_share=h, yaw_rate=CAR.speed * theta / CAR.wheelbase)
    assert car.neutral_rear_difference == pytest.approx(2.7 * theta * h / (2 * 1.5 * (1 - h)), rel=1e-12)
    balanced = dataclasses.replace(car, rear_difference=car.neutral_rear_difference)
    assert abs(balanced.excitation) < 1e-12 * balanced.moment_rate


def test_dropped_steering_rate_is_what_separates_w12_from_the_car():
    """With the steering rate d1' has + Theta' too, so the car answers (N - j w)/(D + j w): more than W12 at any w."""
    frequency, force = 5.0, 0.4 * 2000.0
    _, w12 = dataclasses.replace(CAR, drive_force=2000.0, front_share=0.4).transfer_function().freqresp([frequency])
    half, v_over, k = 1.35, 7.0, 120e3
    a = np.array([[-2 * k / (2400 * v_over), -v_over], [0.0, -2 * half**2 * k / (4200 * v_over)]])
    b = np.array([(k + force) / 2400, half * (k + force) / 4200])
    _, r = np.linalg.solve(1j * frequency * np.eye(2) - a, b)
    complete = 2.7 * r / v_over - 1
    assert complete == pytest.approx(w12[0] - 1j * frequency / (CAR.damping + 1j * frequency), rel=1e-12)


def test_understeer_of_ge_and_ni():
    """m_1/C_1 - m_2/C_2 = 1191.9/21000 - 1308.1/24000 = 2.248e-3 rad s^2/m, v_ch = sqrt(1.72/2.248e-3) = 27.66 m/s."""
    assert axle_cornering_stiffnesses(GE_NI) == (21000.0, 24000.0)
    gradient = 2500 * 0.82 / 1.72 / 21000 - 2500 * 0.90 / 1.72 / 24000
    assert understeer_gradient(GE_NI) == pytest.approx(gradient, rel=1e-12)
    assert characteristic_speed(GE_NI) == pytest.approx(math.sqrt(1.72 / gradient), rel=1e-12)


def test_tyres_whose_force_follows_the_load_steer_neutrally():
    """One friction curve on all wheels: C proportional to the load, m_1/C_1 = m_2/C_2 wherever the mass is."""
    for distance in (0.8, 1.2, 1.6):
        car = Vehicle(centre_of_mass_to_rear_axle=distance)
        assert understeer_gradient(car) == pytest.approx(0.0, abs=1e-15)


def test_slope_of_the_friction_curve_is_the_cornering_stiffness():
    """Burckhardt on dry asphalt: C1 C2 - C3 = 17.135 per load; secant at 1e-6 differs by C2 1e-6/2 of it."""
    car = Vehicle(centre_of_mass_to_rear_axle=2.405 / 2)
    expected = (1.029 * 17.16 - 0.523) * 1400 / 2 * 9.81
    assert axle_cornering_stiffnesses(car) == pytest.approx((expected, expected), rel=2e-5)


def test_oversteer_has_no_characteristic_speed():
    tail_heavy = dataclasses.replace(GE_NI, centre_of_mass_to_rear_axle=0.7)
    assert understeer_gradient(tail_heavy) < 0.0
    assert characteristic_speed(tail_heavy) == math.inf
