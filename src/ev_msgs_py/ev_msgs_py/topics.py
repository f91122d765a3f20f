"""The one topic table: relative name, signal, message, frame and unit of every field.

Names are relative, so that scenario scripts can put several cars side by side, each in its own namespace.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.codec import Codec, FieldCodec, ImuCodec, Joints, JointStateCodec, StampCodec
from ev_msgs_py.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    MotorStates,
    RecorderProgress,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.wheels import WHEEL_NAMES

# Reliable, volatile, keep last. The recorder may lag 200 steps (see lockstep.md); a writer keeps more than that, so
# nothing that the recorder has not acknowledged is ever overwritten.
QUEUE_DEPTH = 256


@dataclass(frozen=True, slots=True, eq=False)
class Topic:
    """One topic of the contract."""

    name: str
    signal: type
    codec: Codec
    frame: str
    units: dict[str, str]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the recorded channels, such as wheel_states.velocity.front_left."""
        prefix = self.name.replace("/", ".")
        return tuple(f"{prefix}.{channel}" for channel in self.codec.shape.channels)


_BRAKES = tuple(f"{wheel}_brake" for wheel in WHEEL_NAMES)
_TORQUES = (Joints(WHEEL_NAMES, effort="drive"), Joints(_BRAKES, effort="brake"))
_TORQUE_UNITS = {"drive": "N m", "brake": "N m"}
_CONTACT = {
    kind: tuple(f"{wheel}_{kind}" for wheel in WHEEL_NAMES) for kind in ("longitudinal", "lateral", "vertical")
}

TOPICS = {
    topic.signal: topic
    for topic in (
        Topic(
            "driver/command",
            DriverCommand,
            JointStateCodec(
                DriverCommand,
                Joints(("drive",), effort="drive_torque"),
                Joints(("brake",), effort="brake_torque"),
                Joints(("steering_wheel",), effort="hand_torque"),
            ),
            frame="base_link",
            units={"drive_torque": "N m", "brake_torque": "N m", "hand_torque": "N m"},
        ),
        Topic(
            "steering_column/state",
            SteeringColumnState,
            JointStateCodec(
                SteeringColumnState,
                Joints(("steering_wheel",), position="angle", velocity="rate", effort="hand_torque"),
                Joints(("road_wheels",), position="road_wheel_angle", velocity="road_wheel_rate"),
            ),
            frame="base_link",
            units={
                "angle": "rad",
                "rate": "rad/s",
                "hand_torque": "N m",
                "road_wheel_angle": "rad",
                "road_wheel_rate": "rad/s",
            },
        ),
        Topic(
            "torque_request",
            WheelTorqueRequest,
            JointStateCodec(WheelTorqueRequest, *_TORQUES),
            frame="base_link",
            units=_TORQUE_UNITS,
        ),
        Topic(
            "torque_command",
            WheelTorqueCommand,
            JointStateCodec(WheelTorqueCommand, *_TORQUES),
            frame="base_link",
            units=_TORQUE_UNITS,
        ),
        Topic(
            "wheel_states",
            WheelStates,
            JointStateCodec(WheelStates, Joints(WHEEL_NAMES, "position", "velocity", "effort")),
            frame="base_link",
            units={"position": "rad", "velocity": "rad/s", "effort": "N m"},
        ),
        Topic(
            "motor_states",
            MotorStates,
            JointStateCodec(MotorStates, Joints(WHEEL_NAMES, velocity="velocity", effort="effort")),
            frame="base_link",
            units={"velocity": "rad/s", "effort": "N m"},
        ),
        Topic(
            "imu",
            InertialMeasurement,
            ImuCodec(
                InertialMeasurement,
                "sensor_msgs/msg/Imu",
                yaw_rate="angular_velocity.z",
                longitudinal_acceleration="linear_acceleration.x",
                lateral_acceleration="linear_acceleration.y",
            ),
            frame="base_link",
            units={"yaw_rate": "rad/s", "longitudinal_acceleration": "m/s^2", "lateral_acceleration": "m/s^2"},
        ),
        Topic(
            "twist",
            BodyVelocity,
            FieldCodec(
                BodyVelocity,
                "geometry_msgs/msg/TwistStamped",
                longitudinal="twist.linear.x",
                lateral="twist.linear.y",
                yaw_rate="twist.angular.z",
            ),
            frame="base_link",
            units={"longitudinal": "m/s", "lateral": "m/s", "yaw_rate": "rad/s"},
        ),
        Topic(
            "pose",
            BodyPose,
            FieldCodec(
                BodyPose,
                "geometry_msgs/msg/PoseStamped",
                x="pose.position.x",
                y="pose.position.y",
                orientation_z="pose.orientation.z",
                orientation_w="pose.orientation.w",
            ),
            frame="odom",
            units={"x": "m", "y": "m", "orientation_z": "1", "orientation_w": "1"},
        ),
        Topic(
            "battery",
            BatteryCondition,
            FieldCodec(
                BatteryCondition,
                "sensor_msgs/msg/BatteryState",
                single_precision=True,
                voltage="voltage",
                current="current",
                charge="charge",
                capacity="capacity",
                state_of_charge="percentage",
            ),
            frame="base_link",
            units={"voltage": "V", "current": "A", "charge": "A h", "capacity": "A h", "state_of_charge": "1"},
        ),
        Topic(
            "tire_forces",
            TireForces,
            JointStateCodec(
                TireForces,
                Joints(_CONTACT["longitudinal"], position="slip_ratio", effort="longitudinal_force"),
                Joints(_CONTACT["lateral"], position="slip_angle", effort="lateral_force"),
                Joints(_CONTACT["vertical"], position="friction_coefficient", effort="load"),
            ),
            frame="base_link",
            units={
                "longitudinal_force": "N",
                "lateral_force": "N",
                "load": "N",
                "slip_ratio": "1",
                "slip_angle": "rad",
                "friction_coefficient": "1",
            },
        ),
        Topic("recorder/progress", RecorderProgress, StampCodec(RecorderProgress), frame="", units={}),
    )
}
