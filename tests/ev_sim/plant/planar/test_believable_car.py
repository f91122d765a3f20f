"""The car with real tyres, roll stiffness and compliance.

It steers as the linear model of its own tyres does.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plant.planar.car import outputs, plant, steered

from ev_core.vehicle.description import Suspension
from ev_msgs_py.contract.signals import TireForces, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.understeer import understeer_gradient
from ev_stack.scenarios.files import vehicle_of
from ev_study.analysis.linear_models import single_track, tangent_speed, yaw_damping, yaw_gain
from ev_study.analysis.linearised_plant import OperatingPoint, linearised

CAR = vehicle_of("compact_ev")
# Drag pitches the car and rolling resistance brakes the outer wheels more: neither is in a linear
# model.
COASTING = dataclasses.replace(CAR, rolling_resistance=0.0, drag_coefficient=0.0)
STILL = WheelTorqueCommand(Wheels.all(0.0))


@pytest.fixture(scope="module")
def fast():
    return linearised(COASTING, OperatingPoint(25.0))


def test_yaw_gain_is_that_of_its_understeer_gradient(fast):
    """V/(L + K V^2); 1e-4 leaves room for the steps of the differences (measured 2e-7)."""
    gain = fast.response(np.array([0.0]))[0, 1].real
    assert gain == pytest.approx(
        25.0 / (CAR.wheelbase + understeer_gradient(CAR) * 625.0), rel=1e-4
    )
    assert gain == pytest.approx(yaw_gain(single_track(COASTING, 25.0)), rel=1e-4)


def test_it_understeers_as_cars_do():
    """Passenger cars have 0.5 to 4 deg for each g (Gillespie, chapter 6)."""
    assert 0.5 < np.degrees(understeer_gradient(CAR) * 9.81) < 4.0
    assert 10.0 < tangent_speed(CAR) < 35.0


def test_damping_is_that_of_the_single_track(fast):
    """Frequency and damping ratio of the yaw motion agree within 1 %.

    The plant's contact slip lags on top (0.8 %).
    """
    ratio, frequency = yaw_damping(single_track(COASTING, 25.0))
    pole = next(
        p for p in sorted(np.linalg.eigvals(fast.system.A), key=lambda p: -p.real) if p.imag > 0.0
    )
    assert abs(pole) == pytest.approx(frequency, rel=0.01)
    assert -pole.real / abs(pole) == pytest.approx(ratio, rel=0.01)


def test_sideslip_changes_sign_at_the_tangent_speed():
    at = tangent_speed(COASTING)
    signs = []
    for speed in (0.97 * at, 1.03 * at):
        system = single_track(COASTING, speed)
        signs.append(np.sign(-(system.C @ np.linalg.solve(system.A, system.B))[0, 0]))
    assert signs == [1.0, -1.0]


def test_outer_wheels_carry_by_stiffness_and_roll_centres():
    """The front share of the lateral transfer is the closed form in a steady bend (1e-9)."""
    driven = plant(CAR, initial_speed=15.0, speed="held")
    for _ in range(600):
        driven.advance(STILL, steered(0.03))
    load = outputs(driven)[TireForces].load
    front, rear = load.front_right - load.front_left, load.rear_right - load.rear_left
    share = front * CAR.front_track / (front * CAR.front_track + rear * CAR.rear_track)
    assert share == pytest.approx(CAR.front_share_of_roll, rel=1e-9)
    assert share == pytest.approx((0.55 * 0.06 + (0.53 - 0.087) * 35.0 / 60.0) / 0.53, rel=1e-9)


def test_two_tyres_of_an_axle_hold_less_than_twice_one():
    """Degressive load of a simple curve: the same bend needs more steering than without it."""
    simple = dataclasses.replace(CAR, tyre=vehicle_of("audi_a2").tyre, suspension=Suspension())
    yaw_rates = []
    for share in (0.0, 0.2):
        car = dataclasses.replace(
            simple, tyre=dataclasses.replace(simple.tyre, load_sensitivity=share)
        )
        driven = plant(car, initial_speed=20.0, speed="held")
        for _ in range(400):
            driven.advance(STILL, steered(0.08))
        yaw_rates.append(driven.state[2])
    assert yaw_rates[1] < 0.99 * yaw_rates[0]


def test_half_a_suspension_is_refused():
    with pytest.raises(ParameterError, match="given both or neither"):
        Suspension(front_roll_stiffness=3e4)
    odd = Suspension(
        front_roll_stiffness=3e4, rear_roll_stiffness=3e4, front_roll_centre_height=2.0
    )
    with pytest.raises(ParameterError, match="of the lateral load transfer, expected 0 to 1"):
        dataclasses.replace(CAR, suspension=odd)
