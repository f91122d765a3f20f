"""An object behind its sensors, as nodes have it."""

from __future__ import annotations

from ev_msgs_py.configuration import configure
from ev_msgs_py.sensors.measured import Measured
from ev_msgs_py.signals import InertialMeasurement, SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.wheels import Wheels

STRAIGHT = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)


def behind(**values: object) -> object:
    """A new planar plant behind sensors; double underscores stand for dots."""
    sensors = {f"sensors.{name.replace('__', '.')}": value for name, value in values.items()}
    return configure("plant", {"method": "planar", **sensors}).create()


def yaw_rate(plant: object) -> float:
    return next(signal.yaw_rate for signal in plant.outputs() if isinstance(signal, InertialMeasurement))


def test_ideal_sensors_are_not_there():
    assert not isinstance(behind(), Measured)
    assert isinstance(behind(wheel_speed__delay=1), Measured)


def test_outputs_are_measured_once_per_period():
    plant = behind(imu_yaw_rate__noise=1.0)
    first = plant.outputs()
    assert plant.outputs() == first
    plant.advance(WheelTorqueCommand(Wheels.all(0.0)), STRAIGHT)
    assert plant.outputs() != first


def test_a_successor_of_a_running_object_goes_on_with_its_state():
    """As when a parameter is set while the node runs: on, changed, off; the first value is a present one."""
    plant = behind()
    for sensors in ({"imu_yaw_rate__delay": 2}, {"imu_yaw_rate__delay": 4, "wheel_speed__bias": 0.5}, {}):
        for _ in range(10):
            plant.advance(WheelTorqueCommand(Wheels.front(100.0, 300.0)), STRAIGHT)
            plant.outputs()
        successor = behind(**sensors)
        successor.state = plant.state
        plant = successor
        plant.advance(WheelTorqueCommand(Wheels.front(100.0, 300.0)), STRAIGHT)
        assert yaw_rate(plant) == plant.state[2] != 0.0
