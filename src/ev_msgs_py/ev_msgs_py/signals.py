"""Every signal of the graph as a plain value: SI units, radians, body frame of REP-103 (x forward, y left, z up).

A signal holds exactly the numbers that its message carries, so a signal that went over DDS is bit-identical to
one that was handed over inside a process. Signals are named tuples because making one and listing its numbers are
most of the cost of a step. Units and messages stand in `topics.TOPICS`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ev_msgs_py.wheels import NO_WHEELS, Wheels


class Instant(NamedTuple):
    """The instant of this step; it needs no topic, because every message carries it as its stamp."""

    time: float


class DriverCommand(NamedTuple):
    """What the driver does: pedals as torques summed over all wheels, and the hands on the steering wheel."""

    drive_torque: float
    brake_torque: float
    hand_torque: float


class SteeringColumnState(NamedTuple):
    """The steering column as the laws may measure it; with a mechanical column angle = i * road_wheel_angle."""

    angle: float
    rate: float
    hand_torque: float
    road_wheel_angle: float
    road_wheel_rate: float


class WheelTorqueRequest(NamedTuple):
    """Torques at the wheels that the electronic differential asks for; brake torques are never negative."""

    drive: Wheels
    brake: Wheels = NO_WHEELS


class WheelTorqueCommand(NamedTuple):
    """Torques at the wheels that the traction control lets through to the drives and brakes."""

    drive: Wheels
    brake: Wheels = NO_WHEELS


class WheelStates(NamedTuple):
    """Turned angle and speed of each wheel, and the drive torque that acts on it."""

    position: Wheels
    velocity: Wheels
    effort: Wheels


class MotorStates(NamedTuple):
    """Speed and electromagnetic torque at the shaft of the motor of each wheel; zero where there is none."""

    velocity: Wheels
    effort: Wheels


class InertialMeasurement(NamedTuple):
    """Yaw rate and accelerations of the centre of mass in the body frame, without gravity."""

    yaw_rate: float
    longitudinal_acceleration: float
    lateral_acceleration: float


class BodyVelocity(NamedTuple):
    """Velocity of the centre of mass in the body frame."""

    longitudinal: float
    lateral: float
    yaw_rate: float


class BodyPose(NamedTuple):
    """Position of the centre of mass and heading in the odom frame; the heading as z and w of the quaternion."""

    x: float
    y: float
    orientation_z: float
    orientation_w: float

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
    """Terminal values of the traction battery (single precision, as BatteryState carries them)."""

    voltage: float
    current: float
    charge: float
    capacity: float
    state_of_charge: float


class TireForces(NamedTuple):
    """Forces of the road on each tyre in the wheel's frame, with slip, load and available friction."""

    longitudinal_force: Wheels
    lateral_force: Wheels
    load: Wheels
    slip_ratio: Wheels
    slip_angle: Wheels
    friction_coefficient: Wheels


class RecorderProgress(NamedTuple):
    """The recorder holds every signal up to the step that this message is stamped with; it carries nothing else."""
