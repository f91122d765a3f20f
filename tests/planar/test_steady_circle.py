"""The planar plant against the closed-form linear two-track car."""

from __future__ import annotations

import pytest

from ev_msgs_py.signals import BodyVelocity, InertialMeasurement, SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.vehicle import Motor, Tyre, Vehicle
from ev_msgs_py.wheels import Wheels
from ev_sim.plant.planar.plant import PlanarParameters, PlanarPlant

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

    r = V delta / (L + m V^2 (b/C_f - a/C_r)/L), beta = r (b - m a V^2/(L C_r))/V, with C of whole axles (for example
    Gillespie, Fundamentals of Vehicle Dynamics, 1992, eqs 6-15 to 6-24).
    """
    car = PlanarPlant(PlanarParameters(initial_speed=speed), CAR, 0.01)
    held = 0.0
    for _ in range(1500):
        error = speed - float(car.state[0])
        held += 5.0 * error
        torque = 500.0 * error + held
        car.advance(WheelTorqueCommand(Wheels.rear(torque, torque)), SteeringColumnState(0, 0, 0, angle, 0))
    mass, wheelbase, b = CAR.mass, CAR.wheelbase, CAR.centre_of_mass_to_rear_axle
    a = wheelbase - b
    front, rear = 2 * FRONT, 2 * REAR
    yaw_rate = speed * angle / (wheelbase + mass * speed**2 * (b / front - a / rear) / wheelbase)
    sideslip = yaw_rate / speed * (b - mass * a * speed**2 / (wheelbase * rear))
    outputs = {type(signal): signal for signal in car.outputs()}
    body, imu = outputs[BodyVelocity], outputs[InertialMeasurement]
    assert imu.yaw_rate == pytest.approx(yaw_rate, rel=5e-3)
    assert body.lateral / body.longitudinal == pytest.approx(sideslip, rel=5e-3)
    assert imu.lateral_acceleration == pytest.approx(speed * yaw_rate, rel=5e-3)
