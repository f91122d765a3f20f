"""What sensors measure: one table of quantities, each some fields of a signal with the same unit."""

from __future__ import annotations

from dataclasses import dataclass, make_dataclass
from functools import cache
from itertools import chain
from typing import Any

from ev_msgs_py.parameters import group
from ev_msgs_py.sensor import sensor_parameters
from ev_msgs_py.shape import shape_of
from ev_msgs_py.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    SteeringColumnState,
    TireForces,
    WheelStates,
)
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


@dataclass(frozen=True)
class Quantity:
    """Fields of a signal that one sensor measures; its parameters accept errors up to `largest`, in `unit`."""

    name: str
    signal: type
    fields: tuple[str, ...]
    largest: float

    @property
    def unit(self) -> str:
        """Unit of the numbers and of the sensor's errors."""
        return shape_of(self.signal).fields[self.fields[0]].unit

    @property
    def parameters(self) -> type:
        """The parameter dataclass of its sensor."""
        return sensor_parameters(self.unit, self.largest)

    def read(self, signal: Any) -> tuple[float, ...]:
        """The numbers in a signal."""
        values = tuple(getattr(signal, name) for name in self.fields)
        return tuple(chain.from_iterable(values)) if shape_of(self.signal).per_wheel else values

    def written(self, signal: Any, numbers: tuple[float, ...]) -> Any:
        """The signal with other numbers."""
        values: tuple[Any, ...] = numbers
        if shape_of(self.signal).per_wheel:
            wheels = len(WHEEL_NAMES)
            values = tuple(Wheels._make(numbers[i : i + wheels]) for i in range(0, len(numbers), wheels))
        return signal._replace(**dict(zip(self.fields, values, strict=True)))


class Heading(Quantity):
    """The heading of a pose, which the signal carries as two numbers of a quaternion."""

    unit = "rad"

    def read(self, signal: BodyPose) -> tuple[float, ...]:
        return (signal.heading,)

    def written(self, signal: BodyPose, numbers: tuple[float, ...]) -> BodyPose:
        return BodyPose.at(signal.x, signal.y, *numbers)


class StateOfCharge(Quantity):
    """The state of charge; the charge that is shown is its share of the capacity."""

    def read(self, signal: BatteryCondition) -> tuple[float, ...]:
        return (signal.state_of_charge,)

    def written(self, signal: BatteryCondition, numbers: tuple[float, ...]) -> BatteryCondition:
        (share,) = numbers
        return signal._replace(state_of_charge=share, charge=share * signal.capacity)


QUANTITIES = (
    Quantity("wheel_angle", WheelStates, ("position",), 10.0),
    Quantity("wheel_speed", WheelStates, ("velocity",), 100.0),
    Quantity("wheel_torque", WheelStates, ("effort",), 1e4),
    Quantity("motor_speed", MotorStates, ("velocity",), 1000.0),
    Quantity("motor_torque", MotorStates, ("effort",), 1e4),
    Quantity("imu_yaw_rate", InertialMeasurement, ("yaw_rate",), 10.0),
    Quantity("imu_acceleration", InertialMeasurement, ("longitudinal_acceleration", "lateral_acceleration"), 100.0),
    Quantity("body_velocity", BodyVelocity, ("longitudinal", "lateral"), 100.0),
    Quantity("body_yaw_rate", BodyVelocity, ("yaw_rate",), 10.0),
    Quantity("body_position", BodyPose, ("x", "y"), 1000.0),
    Heading("body_heading", BodyPose, ("orientation_z", "orientation_w"), 10.0),
    Quantity("battery_voltage", BatteryCondition, ("voltage",), 1000.0),
    Quantity("battery_current", BatteryCondition, ("current",), 1000.0),
    StateOfCharge("battery_state_of_charge", BatteryCondition, ("state_of_charge", "charge"), 1.0),
    Quantity("tire_force", TireForces, ("longitudinal_force", "lateral_force"), 1e5),
    Quantity("tire_load", TireForces, ("load",), 1e5),
    Quantity("tire_slip_ratio", TireForces, ("slip_ratio",), 1.0),
    Quantity("tire_slip_angle", TireForces, ("slip_angle",), 1.0),
    Quantity("tire_friction", TireForces, ("friction_coefficient",), 1.0),
    Quantity("steering_angle", SteeringColumnState, ("angle",), 10.0),
    Quantity("steering_rate", SteeringColumnState, ("rate",), 100.0),
    Quantity("hand_torque", SteeringColumnState, ("hand_torque",), 100.0),
    Quantity("road_wheel_angle", SteeringColumnState, ("road_wheel_angle",), 1.0),
    Quantity("road_wheel_rate", SteeringColumnState, ("road_wheel_rate",), 10.0),
)


@cache
def sensors_for(signals: tuple[type, ...]) -> type:
    """The parameter dataclass with one group for each quantity of these signals, by its name."""
    groups = [(q.name, q.parameters, group(q.parameters)) for q in QUANTITIES if q.signal in signals]
    return make_dataclass("Sensors", groups, frozen=True, slots=True)
