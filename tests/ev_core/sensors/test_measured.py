"""A part behind its sensors, as nodes have it."""

from __future__ import annotations

from typing import Any

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import Sensed, hand_over, part_of
from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.signals import InertialMeasurement, WheelTorqueCommand


def behind(**values: object) -> Any:
    """A new planar plant behind sensors; double underscores stand for dots."""
    sensors = {f"sensors.{name.replace('__', '.')}": value for name, value in values.items()}
    return part_of(configure("plant", {"method": "planar", **sensors}), compiled=False)


def driven(left: float, right: float) -> Frame:
    """The frame in which the front wheels are driven [N m]."""
    here = Frame()
    here.numbers[PLACES[WheelTorqueCommand]] = numbers_of([left, right, *[0.0] * 6])
    return here


def yaw_rate(there: Frame) -> float:
    return there.numbers[PLACES[InertialMeasurement].start]


def test_ideal_sensors_are_not_there():
    assert not isinstance(behind(), Sensed)
    assert isinstance(behind(wheel_speed__delay=1), Sensed)


def test_outputs_are_measured_in_every_period():
    plant, first, second = behind(imu_yaw_rate__noise=1.0), Frame(), Frame()
    plant.start(first)
    plant.step(driven(0.0, 0.0), second)
    assert yaw_rate(first) != 0.0
    assert yaw_rate(second) not in (0.0, yaw_rate(first))


def test_a_successor_of_a_running_part_goes_on_with_its_state():
    """A parameter set while the node runs, on, changed, off: the first value is a present one."""
    plant, there = behind(), Frame()
    plant.start(there)
    for sensors in (
        {"imu_yaw_rate__delay": 2},
        {"imu_yaw_rate__delay": 4, "wheel_speed__bias": 0.5},
        {},
    ):
        for _ in range(10):
            plant.step(driven(100.0, 300.0), there)
        successor = behind(**sensors)
        hand_over(plant, successor)
        plant = successor
        plant.step(driven(100.0, 300.0), there)
        assert yaw_rate(there) == plant.state[2] != 0.0


def test_the_same_sensors_go_on_where_they_were():
    """Another parameter of the plant changes: what is under way in a delay line stays under way."""
    first, second = behind(imu_yaw_rate__delay=3), behind(imu_yaw_rate__delay=3)
    there, other = Frame(), Frame()
    first.start(there)
    for _ in range(20):
        first.step(driven(100.0, 300.0), there)
    hand_over(first, second)
    for _ in range(5):
        first.step(driven(0.0, 0.0), there)
        second.step(driven(0.0, 0.0), other)
        assert there.numbers.tobytes() == other.numbers.tobytes()
