"""What sensors measure: one table of quantities, each some fields of a signal with the same unit."""

from __future__ import annotations

from dataclasses import dataclass, make_dataclass
from functools import cache, cached_property

from ev_msgs_py.contract import frame
from ev_msgs_py.parameters import group
from ev_msgs_py.sensors.measuring import HEADING, NUMBERS, SHARE
from ev_msgs_py.sensors.sensor import sensor_parameters
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


@dataclass(frozen=True)
class Quantity:
    """Fields of a signal that one sensor measures; its parameters accept errors up to `largest`, in `unit`.

    `kind` says how the fields carry what is measured: as its numbers; as z and w of a quaternion; or as a share and the
    amount that this is of a further field, `whole`.
    """

    name: str
    signal: type
    fields: tuple[str, ...]
    largest: float
    kind: int = NUMBERS
    whole: str = ""

    @property
    def unit(self) -> str:
        """Unit of the numbers and of the sensor's errors."""
        return "rad" if self.kind == HEADING else shape_of(self.signal).fields[self.fields[0]].unit

    @property
    def parameters(self) -> type:
        """The parameter dataclass of its sensor."""
        return sensor_parameters(self.unit, self.largest)

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Where its fields stand in the frame, and then the whole; numbers stand one after the other."""
        channels = shape_of(self.signal).channels
        fields = (*self.fields, self.whole)
        begin = frame.PLACES[self.signal].start
        return tuple(begin + i for f in fields for i, name in enumerate(channels) if name.partition(".")[0] == f)

    @property
    def count(self) -> int:
        """How many numbers have errors."""
        return len(self.places) if self.kind == NUMBERS else 1


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
    Quantity("body_heading", BodyPose, ("orientation_z", "orientation_w"), 10.0, HEADING),
    Quantity("battery_voltage", BatteryCondition, ("voltage",), 1000.0),
    Quantity("battery_current", BatteryCondition, ("current",), 1000.0),
    Quantity("battery_state_of_charge", BatteryCondition, ("state_of_charge", "charge"), 1.0, SHARE, "capacity"),
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
