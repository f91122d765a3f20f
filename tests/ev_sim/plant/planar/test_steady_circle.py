"""The planar plant against the linear single-track car: steady circle and step steer."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import scipy.signal
from plant.planar.car import outputs, plant, steered

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import BodyVelocity, InertialMeasurement, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels

FRONT, REAR = 55e3, 65e3
CAR = Vehicle(
    driven_wheels=("rear_left", "rear_right"),
    rolling_resistance=0.0,
    drag_coefficient=0.0,
    motor=Motor(peak_torque=500.0, peak_power=1e5),
    tyre=Tyre(
        curve="linear",
        coefficients=(20.0, 0.0, 0.0, 0.0),
        combined="uncoupled",
        lateral_curve="linear",
        front_cornering_stiffness=FRONT,
        rear_cornering_stiffness=REAR,
    ),
)


@pytest.mark.parametrize("speed", [5.0, 12.0, 20.0])
@pytest.mark.parametrize("angle", [0.01, -0.01])
def test_steady_circle(speed, angle):
    """Yaw rate, sideslip and lateral acceleration within 0.5 %.

    r = V delta / (L + m V^2 (b/C_f - a/C_r)/L), beta = r (b - m a V^2/(L C_r))/V, with C of whole
    axles (for example Gillespie, Fundamentals of Vehicle Dynamics, 1992, chapter 6).
    """
    car = plant(CAR, initial_speed=speed)
    held = 0.0
    for _ in range(1500):
        error = speed - float(car.state[0])
        held += 5.0 * error
        torque = 500.0 * error + held
        car.advance(WheelTorqueCommand(Wheels.rear(torque, torque)), steered(angle))
    mass, wheelbase, b = CAR.mass, CAR.wheelbase, CAR.centre_of_mass_to_rear_axle
    a = wheelbase - b
    front, rear = 2 * FRONT, 2 * REAR
    yaw_rate = speed * angle / (wheelbase + mass * speed**2 * (b / front - a / rear) / wheelbase)
    sideslip = yaw_rate / speed * (b - mass * a * speed**2 / (wheelbase * rear))
    seen = outputs(car)
    body, imu = seen[BodyVelocity], seen[InertialMeasurement]
    assert imu.yaw_rate == pytest.approx(yaw_rate, rel=5e-3)
    assert body.lateral / body.longitudinal == pytest.approx(sideslip, rel=5e-3)
    assert imu.lateral_acceleration == pytest.approx(speed * yaw_rate, rel=5e-3)


@pytest.mark.parametrize("speed", [10.0, 20.0])
def test_step_steer(speed):
    """Yaw rate and sideslip over 2 s within 2 % of their peaks of the linear single-track model.

    States beta and r: m V (beta' + r) = F_f + F_r, J_z r' = a F_f - b F_r, F = -C alpha. The
    carcass is stiff, because the single-track model has none.
    """
    tyre = dataclasses.replace(CAR.tyre, lateral_stiffness=1e7, lateral_damping_time=0.001)
    vehicle = dataclasses.replace(CAR, tyre=tyre)
    angle, period = 0.01, 0.01
    car = plant(vehicle, period, initial_speed=speed)
    yaw_rate, sideslip = [0.0], [0.0]
    for _ in range(200):
        torque = 2000.0 * (speed - float(car.state[0]))
        car.advance(WheelTorqueCommand(Wheels.rear(torque, torque)), steered(angle))
        yaw_rate.append(car.state[2])
        sideslip.append(car.state[1] / car.state[0])
    m, jz, b, front, rear = (
        CAR.mass,
        CAR.yaw_inertia,
        CAR.centre_of_mass_to_rear_axle,
        2 * FRONT,
        2 * REAR,
    )
    a = CAR.wheelbase - b
    system = scipy.signal.StateSpace(
        [
            [-(front + rear) / (m * speed), -1.0 - (a * front - b * rear) / (m * speed**2)],
            [-(a * front - b * rear) / jz, -(a**2 * front + b**2 * rear) / (jz * speed)],
        ],
        [[front / (m * speed)], [a * front / jz]],
        np.eye(2),
        np.zeros((2, 1)),
    )
    time = np.arange(201) * period
    _, expected, _ = scipy.signal.lsim(system, np.full(201, angle), time)
    assert np.abs(np.array(sideslip) - expected[:, 0]).max() < 0.02 * np.abs(expected[:, 0]).max()
    assert np.abs(np.array(yaw_rate) - expected[:, 1]).max() < 0.02 * np.abs(expected[:, 1]).max()
