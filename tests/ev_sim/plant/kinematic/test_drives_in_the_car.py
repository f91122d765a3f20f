"""Drives of the kinematic plant give, in each depth of detail."""

from dataclasses import replace

import pytest
from plant.kinematic.car import (
    AUDI,
    PERIOD,
    ROLLING_TORQUE,
    WITHOUT_DRAG,
    WITHOUT_RESISTANCE,
    Car,
    torque,
)

from ev_msgs_py.contract.signals import MotorStates, WheelStates, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.drives.drive import DRIVE_MODELS


@pytest.mark.parametrize("drive", DRIVE_MODELS[1:])
def test_car_with_real_drives_moves_like_one_with_ideal_drives(drive):
    """The car reaches 15 km/h in 4 s.

    1 % is what commutation takes from the torque up to this speed.
    """
    command = torque(1400.0 * 15 / 3.6 / 4 * 0.294 + ROLLING_TORQUE)
    ideal = Car(drive="ideal").drive(command, steps=400)
    assert ideal.speed == pytest.approx(15 / 3.6, rel=0.01)
    assert Car(drive=drive).drive(command, steps=400).speed == pytest.approx(ideal.speed, rel=0.01)


@pytest.mark.parametrize("drive", DRIVE_MODELS[1:])
def test_second_turn_loses_current_control_on_a_bus_of_300_volt_by_the_reading_as_phases(drive):
    """34 N m at each front wheel carry the car through the second turn.

    7 %: commutation at 95 rad/s.

    With the motor data of each phase the EMF of the outer (left) motor is 381 V: at 300 V it
    brakes. With those of the armature winding it is 190 V, and its torque is there.
    """

    def outer_torque(winding, bus_voltage):
        values = {"drive": drive, "bus_voltage": bus_voltage, "motor.winding": winding}
        car = Car(WITHOUT_RESISTANCE, initial_speed=30 / 3.6, **values)
        return car.drive(torque(68.0), degrees=-30.0, steps=10)[WheelStates].effort.front_left

    assert outer_torque("phase", 480.0) == pytest.approx(34.0, rel=0.07)
    assert outer_torque("phase", 300.0) < -50.0
    for bus_voltage in (300.0, 480.0):
        assert outer_torque("armature", bus_voltage) == pytest.approx(34.0, rel=0.07)


def test_wheel_torque_is_the_mean_over_the_period_and_motor_torque_is_the_one_now():
    """The speed follows from wheel torques to rounding, while the motor shows its chopping."""
    car = Car(WITHOUT_DRAG, drive="switched", initial_speed=4.0).drive(torque(300.0), steps=20)
    before = car.speed
    car.drive(torque(300.0))
    wheels, motors = car[WheelStates].effort, car[MotorStates].effort
    force = (sum(wheels) - ROLLING_TORQUE) / 0.294
    assert car.speed - before == pytest.approx(force / 1400.0 * PERIOD, rel=1e-9)
    assert wheels.front_left != pytest.approx(2.65 * motors.front_left, rel=1e-6)
    # band of 0.5 A in 14 A, and a dip
    assert wheels.front_left == pytest.approx(2.65 * motors.front_left, rel=0.1)


def test_rear_drive_turns_the_rear_motors_only():
    car = Car(replace(AUDI, driven_wheels=("rear_left", "rear_right")))
    car.drive(WheelTorqueCommand(Wheels.rear(200.0, 200.0)), steps=10)
    assert car.speed > 0.0
    assert car[WheelStates].effort == pytest.approx(Wheels.rear(200.0, 200.0), rel=1e-12)
    assert car[MotorStates].velocity.front_left == 0.0 < car[MotorStates].velocity.rear_left
