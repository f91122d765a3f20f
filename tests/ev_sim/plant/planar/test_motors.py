"""Motors in the car: lag, losses, overload, brushless drives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plant.planar.car import drive, plant

from ev_core.vehicle.battery import Battery
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.plant.planar.planar_state import index


def test_torque_lag_is_first_order():
    """63.2 % after one time constant; the impulse over it is tau/e, exactly, whatever the step."""
    car = plant(Vehicle(motor=Motor(torque_lag=0.05)))
    impulse = 0.0
    for _ in range(5):
        out = drive(car, 0.01, Wheels.front(100.0, 100.0))
        impulse += out[WheelStates].effort.front_left * 0.01
    assert car.state[index("motor_torque")] * 2.65 == pytest.approx(100.0 * (1.0 - math.exp(-1.0)))
    assert impulse == pytest.approx(100.0 * 0.05 / math.e)


def test_efficiency_map_in_the_plant():
    motor = Motor(
        map_speed=(100.0, 400.0), map_torque=(10.0, 100.0), map_efficiency=(0.8, 0.9, 0.85, 0.95)
    )
    car = plant(Vehicle(motor=motor), initial_speed=10.0)
    drive(car, 1.0, Wheels.front(265.0, 265.0))
    given, used = car.state[index("battery_work")], car.state[index("drive_work")]
    assert used / given == pytest.approx(0.9, abs=0.02)  # at 100 N m and about 100 rad/s


def test_holding_a_car_by_its_motors_empties_the_battery():
    """A second at rest under brakes with 100 N m at each motor.

    Twice 5000 W (1/0.6 - 1), and the auxiliaries.
    """
    efficiency = (0.5, 0.6, 0.8, 0.7, 0.85, 0.95)  # for each speed a row over the torques
    motor = Motor(
        map_speed=(50.0, 100.0, 400.0), map_torque=(10.0, 100.0), map_efficiency=efficiency
    )
    car = plant(Vehicle(motor=motor, battery=Battery(auxiliary_power=300.0)))
    drive(car, 3.0, Wheels.front(265.0, 265.0), brake=1000.0)
    before = car.state.copy()
    drive(car, 1.0, Wheels.front(265.0, 265.0), brake=1000.0)
    loss, given, used = (
        car.state[index(name)] - before[index(name)]
        for name in ("motor_loss", "battery_work", "auxiliary_work")
    )
    assert loss == pytest.approx(2 * 5000.0 * (1 / 0.6 - 1.0), rel=1e-6)
    assert used == pytest.approx(300.0, rel=1e-6)
    assert given == pytest.approx(loss + used, rel=1e-6)


def test_overload_ends_at_the_nominal_torque():
    motor = Motor(overload_time=2.0, peak_torque=250.0, nominal_torque=150.0)
    moved = plant(Vehicle(motor=motor), road__grade=(0.1,))
    out = drive(moved, 0.5, Wheels.front(500.0, 500.0))
    assert out[WheelStates].effort.front_left == pytest.approx(500.0, rel=1e-3)
    out = drive(moved, 5.0, Wheels.front(500.0, 500.0))
    assert out[WheelStates].effort.front_left == pytest.approx(150.0 * 2.65, rel=0.06)


@pytest.mark.parametrize("kind", ["ideal", "averaged", "switched"])
def test_brushless_drives_plug_in(kind):
    """Drives of Shchur's car give the command in the mean; losses are in the balance."""
    moved = plant(Vehicle(), drive=kind, initial_speed=4.0)
    out = drive(moved, 1.0, Wheels.front(100.0, 100.0))
    mean = np.mean(
        [drive(moved, 0.01, Wheels.front(100.0, 100.0))[WheelStates].effort[0] for _ in range(50)]
    )
    assert mean == pytest.approx(100.0, rel=0.03)
    assert out[WheelStates].velocity.front_left > 4.0 / 0.294
    state = moved.state
    balance = (
        state[index("motor_loss")] + state[index("driveline_loss")] + state[index("drive_work")]
    )
    assert state[index("battery_work")] == pytest.approx(balance, rel=1e-9)
    # two motors, an armature winding of 0.15 ohm and 0.2 Wb, i = M/(p psi), 1.5 s [J]
    copper = 2 * 0.15 * (100.0 / 2.65 / 2.0) ** 2 * 1.5
    assert state[index("motor_loss")] == pytest.approx(
        0.0 if kind == "ideal" else copper, rel=0.15, abs=1.0
    )
