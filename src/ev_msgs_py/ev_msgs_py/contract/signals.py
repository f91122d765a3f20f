"""Signals of the graph as plain values, in SI units and the body frame of REP-103.

A signal holds exactly the numbers that its message carries, so a signal that went over DDS is
bit-identical to one that was handed over inside a process. All that is known of a field stands at
the field; topics and frames of reference stand in `topics.TOPICS`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from ev_msgs_py.contract.fields import Field, leftward, magnitude
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels


class Instant(NamedTuple):
    """Instant of this step; every message carries it as its stamp."""

    time: float


class DriverCommand(NamedTuple):
    """Pedals as torques summed over all wheels, and the hands on the steering wheel."""

    drive_torque: Annotated[
        float, Field("N m", "of all drives together, negative to slow down", "drive.effort")
    ]
    brake_torque: Annotated[
        float, magnitude("N m", "of all brakes together, never negative", "brake.effort")
    ]
    hand_torque: Annotated[
        float, leftward("N m", "on the steering wheel, left positive", "steering_wheel.effort")
    ]


class SteeringColumnState(NamedTuple):
    """Steering column as laws measure it; a mechanical one has angle = i * road_wheel_angle."""

    angle: Annotated[
        float,
        leftward("rad", "of the steering wheel", "steering_wheel.position", "steering_angle", 10.0),
    ]
    rate: Annotated[
        float,
        leftward(
            "rad/s", "of the steering wheel", "steering_wheel.velocity", "steering_rate", 100.0
        ),
    ]
    hand_torque: Annotated[
        float,
        leftward(
            "N m", "of the driver, left positive", "steering_wheel.effort", "hand_torque", 100.0
        ),
    ]
    road_wheel_angle: Annotated[
        float,
        leftward(
            "rad", "mean of the front wheels", "road_wheels.position", "road_wheel_angle", 1.0
        ),
    ]
    road_wheel_rate: Annotated[
        float,
        leftward(
            "rad/s", "mean of the front wheels", "road_wheels.velocity", "road_wheel_rate", 10.0
        ),
    ]


_Drive = Annotated[Wheels, Field("N m", "drive torque at the wheel", "{wheel}.effort")]
_Brake = Annotated[
    Wheels, magnitude("N m", "brake torque at the wheel, never negative", "{wheel}_brake.effort")
]


class WheelTorqueRequest(NamedTuple):
    """Wheel torques that the electronic differential asks for; brake torques never negative."""

    drive: _Drive
    brake: _Brake = NO_WHEELS


class WheelTorqueCommand(NamedTuple):
    """Torques at the wheels that the traction control lets through to the drives and brakes."""

    drive: _Drive
    brake: _Brake = NO_WHEELS


class WheelStates(NamedTuple):
    """Turned angle and speed of each wheel, and the drive torque that acts on it."""

    position: Annotated[
        Wheels,
        Field("rad", "angle turned since the start", "{wheel}.position", "wheel_angle", 10.0),
    ]
    velocity: Annotated[
        Wheels, Field("rad/s", "speed, forwards positive", "{wheel}.velocity", "wheel_speed", 100.0)
    ]
    effort: Annotated[
        Wheels,
        Field(
            "N m", "drive torque, mean over the last period", "{wheel}.effort", "wheel_torque", 1e4
        ),
    ]


class MotorStates(NamedTuple):
    """Speed and electromagnetic torque at the motor shaft of each wheel; zero without a motor."""

    velocity: Annotated[
        Wheels, Field("rad/s", "speed of the shaft", "{wheel}.velocity", "motor_speed", 1000.0)
    ]
    effort: Annotated[
        Wheels, Field("N m", "torque at the shaft", "{wheel}.effort", "motor_torque", 1e4)
    ]


class InertialMeasurement(NamedTuple):
    """Yaw rate and accelerations of the centre of mass in the body frame, without gravity."""

    yaw_rate: Annotated[
        float, leftward("rad/s", "left positive", "angular_velocity.z", "imu_yaw_rate", 10.0)
    ]
    longitudinal_acceleration: Annotated[
        float, Field("m/s^2", "forwards", "linear_acceleration.x", "imu_acceleration", 100.0)
    ]
    lateral_acceleration: Annotated[
        float, leftward("m/s^2", "to the left", "linear_acceleration.y", "imu_acceleration", 100.0)
    ]


class BodyVelocity(NamedTuple):
    """Velocity of the centre of mass in the body frame."""

    longitudinal: Annotated[
        float, Field("m/s", "forwards", "twist.linear.x", "body_velocity", 100.0)
    ]
    lateral: Annotated[
        float, leftward("m/s", "to the left", "twist.linear.y", "body_velocity", 100.0)
    ]
    yaw_rate: Annotated[
        float, leftward("rad/s", "left positive", "twist.angular.z", "body_yaw_rate", 10.0)
    ]


class BodyPose(NamedTuple):
    """Position of the centre of mass, and heading as z and w of the quaternion, in odom."""

    x: Annotated[
        float, Field("m", "of the centre of mass", "pose.position.x", "body_position", 1e3)
    ]
    y: Annotated[
        float, leftward("m", "of the centre of mass", "pose.position.y", "body_position", 1e3)
    ]
    orientation_z: Annotated[
        float, leftward("1", "sine of half the heading", "pose.orientation.z", "body_heading", 10.0)
    ]
    orientation_w: Annotated[
        float, Field("1", "cosine of half the heading", "pose.orientation.w", "body_heading", 10.0)
    ]

    @classmethod
    def at(cls, x: float, y: float, heading: float) -> BodyPose:
        """The pose with a heading in radians, counter-clockwise from the x axis of odom."""
        return cls(x, y, math.sin(heading / 2), math.cos(heading / 2))

    @property
    def heading(self) -> float:
        """Heading in -pi..pi [rad]."""
        heading = 2 * math.atan2(self.orientation_z, self.orientation_w)
        return math.remainder(heading, math.tau)


class BatteryCondition(NamedTuple):
    """Terminal values of the traction battery, in single precision."""

    voltage: Annotated[
        float,
        magnitude(
            "V", "at the terminals", "voltage", "battery_voltage", 1e3, single_precision=True
        ),
    ]
    current: Annotated[
        float,
        Field("A", "into the battery", "current", "battery_current", 1e3, single_precision=True),
    ]
    charge: Annotated[
        float, Field("A h", "left", "charge", "battery_state_of_charge", 1.0, single_precision=True)
    ]
    capacity: Annotated[
        float, Field("A h", "between empty and full", "capacity", single_precision=True)
    ]
    state_of_charge: Annotated[
        float,
        magnitude(
            "1",
            "charge over capacity",
            "percentage",
            "battery_state_of_charge",
            1.0,
            single_precision=True,
        ),
    ]


class TireForces(NamedTuple):
    """Forces of the road on each tyre, with slip, load and available friction."""

    longitudinal_force: Annotated[
        Wheels, Field("N", "along the wheel", "{wheel}_longitudinal.effort", "tire_force", 1e5)
    ]
    lateral_force: Annotated[
        Wheels, leftward("N", "across the wheel", "{wheel}_lateral.effort", "tire_force", 1e5)
    ]
    load: Annotated[
        Wheels, magnitude("N", "on the road", "{wheel}_vertical.effort", "tire_load", 1e5)
    ]
    slip_ratio: Annotated[
        Wheels,
        Field("1", "sign of its force", "{wheel}_longitudinal.position", "tire_slip_ratio", 1.0),
    ]
    slip_angle: Annotated[
        Wheels, leftward("rad", "left positive", "{wheel}_lateral.position", "tire_slip_angle", 1.0)
    ]
    friction_coefficient: Annotated[
        Wheels, magnitude("1", "available", "{wheel}_vertical.position", "tire_friction", 1.0)
    ]


class RecorderProgress(NamedTuple):
    """Progress of the recorder: it holds every signal up to the stamp of this message."""
