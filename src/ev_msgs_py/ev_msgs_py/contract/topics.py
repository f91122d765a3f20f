"""The one topic table: relative name, signal, message and frame of reference.

Names are relative, so that scenario scripts can put several cars side by side, each in its own namespace.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.fields import Shape, shape_of
from ev_msgs_py.contract.optional_signals import (
    BenchElectrical,
    BenchEnergy,
    BenchShafts,
    BenchTemperatures,
    BusStates,
    CellCondition,
    FeedbackFrames,
    LoadCommand,
    MotorElectrics,
    MotorTemperatures,
    RearSteeringState,
    SetPointFrames,
    WheelSpeedCommand,
)
from ev_msgs_py.contract.signals import (
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

# Reliable, volatile, keep last. The recorder may lag 200 steps (see lockstep.md); a writer keeps more than that, so
# nothing that the recorder has not acknowledged is ever overwritten.
QUEUE_DEPTH = 256

JOINT_STATE = "sensor_msgs/msg/JointState"


@dataclass(frozen=True, slots=True, eq=False)
class Topic:
    """One topic of the contract."""

    name: str
    signal: type
    message_type: str
    frame: str = "base_link"

    @property
    def shape(self) -> Shape:
        """The numbers of the signal."""
        return shape_of(self.signal)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the recorded channels, such as wheel_states.velocity.front_left."""
        prefix = self.name.replace("/", ".")
        return tuple(f"{prefix}.{channel}" for channel in self.shape.channels)


TOPICS = {
    topic.signal: topic
    for topic in (
        Topic("driver/command", DriverCommand, JOINT_STATE),
        Topic("steering_column/state", SteeringColumnState, JOINT_STATE),
        Topic("torque_request", WheelTorqueRequest, JOINT_STATE),
        Topic("torque_command", WheelTorqueCommand, JOINT_STATE),
        Topic("speed_command", WheelSpeedCommand, JOINT_STATE),
        Topic("wheel_states", WheelStates, JOINT_STATE),
        Topic("motor_states", MotorStates, JOINT_STATE),
        Topic("imu", InertialMeasurement, "sensor_msgs/msg/Imu"),
        Topic("twist", BodyVelocity, "geometry_msgs/msg/TwistStamped"),
        Topic("pose", BodyPose, "geometry_msgs/msg/PoseStamped", frame="odom"),
        Topic("battery", BatteryCondition, "sensor_msgs/msg/BatteryState"),
        Topic("tire_forces", TireForces, JOINT_STATE),
        Topic("motor_electrics", MotorElectrics, JOINT_STATE),
        Topic("motor_temperatures", MotorTemperatures, JOINT_STATE),
        Topic("battery/cell", CellCondition, "sensor_msgs/msg/BatteryState"),
        Topic("rear_steering/state", RearSteeringState, JOINT_STATE),
        Topic("bench/load_command", LoadCommand, JOINT_STATE),
        Topic("bench/shafts", BenchShafts, JOINT_STATE),
        Topic("bench/electrical", BenchElectrical, JOINT_STATE),
        Topic("bench/temperatures", BenchTemperatures, JOINT_STATE),
        Topic("bench/energy", BenchEnergy, JOINT_STATE),
        Topic("can/set_points", SetPointFrames, JOINT_STATE),
        Topic("can/feedback", FeedbackFrames, JOINT_STATE),
        Topic("can/bus", BusStates, JOINT_STATE),
        Topic("recorder/progress", RecorderProgress, "std_msgs/msg/Header", frame=""),
    )
}
