"""The signals of the plant as one row of numbers, filled by compiled code, in the order that messages have."""

from __future__ import annotations

from math import asin, cos, sin

import numpy as np

from ev_msgs_py.shape import shape_of
from ev_msgs_py.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    TireForces,
    WheelStates,
)
from ev_sim.battery.resistive import current_at_power, open_circuit_voltage
from ev_sim.compiled import compiled
from ev_sim.driveline.couplings import shaft_speeds
from ev_sim.plant.planar.body import HEADING, VX, VY, WHEEL_ANGLE, WHEEL_SPEED, YAW_RATE
from ev_sim.plant.planar.powertrain import BATTERY_POWER, MOTOR_TORQUE, STATE_OF_CHARGE
from ev_sim.plant.planar.state import X, Y

SIGNALS = (
    WheelStates,
    MotorStates,
    InertialMeasurement,
    BodyVelocity,
    BodyPose,
    BatteryCondition,
    TireForces,
)
_SHAPES = tuple(shape_of(signal) for signal in SIGNALS)
_ENDS = tuple(int(end) for end in np.cumsum([len(shape.channels) for shape in _SHAPES]))
_PLACES = tuple(zip(_SHAPES, (0, *_ENDS), _ENDS, strict=False))
SIZE = _ENDS[-1]

(_WHEELS, _MOTORS, _IMU, _VELOCITY, _POSE, _BATTERY, _TYRES) = (place for _, place, _ in _PLACES)
_LOAD = _TYRES + TireForces._fields.index("load") * 4


def signals_of(row: list[float]) -> tuple:
    """The signals that a row of numbers, of length `SIZE`, stands for."""
    return tuple([shape.signal_of(row[begin:end]) for shape, begin, end in _PLACES])


def loads_of(row: np.ndarray) -> np.ndarray:
    """The wheel loads in a row of numbers, (4,) [N]."""
    return row[_LOAD : _LOAD + 4]


@compiled
def show(state: np.ndarray, car, step, voltages: np.ndarray, shaft: np.ndarray, row: np.ndarray) -> None:
    """Write the signals at the instant of the state into `row`, of shape (SIZE,); `shaft` of shape (4,) is scratch.

    Units as in ev_msgs_py.topics. The battery's numbers are rounded to the single precision that its message carries.
    """
    shaft_speeds(car.coupling, state[WHEEL_SPEED : WHEEL_SPEED + 4], car.driven, shaft)
    for i in range(4):
        row[_WHEELS + i] = state[WHEEL_ANGLE + i]
        row[_WHEELS + 4 + i] = state[WHEEL_SPEED + i]
        row[_WHEELS + 8 + i] = step.mean_drive[i]
        row[_MOTORS + i] = shaft[i] * car.driven[i] * car.gear
        row[_MOTORS + 4 + i] = state[MOTOR_TORQUE + i]
        row[_TYRES + i] = step.force_x[i]
        row[_TYRES + 4 + i] = step.force_y[i]
        row[_TYRES + 8 + i] = step.load[i]
        row[_TYRES + 12 + i] = step.slip_x[i]
        row[_TYRES + 16 + i] = -asin(min(max(step.slip_y[i], -1.0), 1.0))
        row[_TYRES + 20 + i] = step.tyre[i, 5]
    row[_IMU] = row[_VELOCITY + 2] = state[YAW_RATE]
    row[_IMU + 1], row[_IMU + 2] = step.acceleration_x, step.acceleration_y
    row[_VELOCITY], row[_VELOCITY + 1] = state[VX], state[VY]
    row[_POSE], row[_POSE + 1] = state[X], state[Y]
    row[_POSE + 2], row[_POSE + 3] = sin(state[HEADING] / 2), cos(state[HEADING] / 2)
    charge = state[STATE_OF_CHARGE]
    source = open_circuit_voltage(voltages, charge)
    current = current_at_power(source, car.battery_resistance, state[BATTERY_POWER])
    capacity = car.battery_charge / 3600.0
    row[_BATTERY] = np.float32(source - car.battery_resistance * current)
    row[_BATTERY + 1] = np.float32(-current)  # BatteryState counts the current into the battery
    row[_BATTERY + 2] = np.float32(charge * capacity)
    row[_BATTERY + 3] = np.float32(capacity)
    row[_BATTERY + 4] = np.float32(charge)
