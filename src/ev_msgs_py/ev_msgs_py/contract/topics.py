"""The one topic table: relative name, signal, message and frame of reference.

Names are relative, so that scenario scripts can put several cars side by side, each in its own
namespace.
"""

from dataclasses import dataclass

from ev_msgs_py.contract import optional_signals as optional
from ev_msgs_py.contract import signals
from ev_msgs_py.contract.fields import Shape, shape_of

# Reliable, volatile, keep last. The recorder may lag 200 steps (see lockstep.md); a writer keeps
# more than that, so nothing that the recorder has not acknowledged is ever overwritten.
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
        Topic("driver/command", signals.DriverCommand, JOINT_STATE),
        Topic("steering_column/state", signals.SteeringColumnState, JOINT_STATE),
        Topic("torque_request", signals.WheelTorqueRequest, JOINT_STATE),
        Topic("torque_command", signals.WheelTorqueCommand, JOINT_STATE),
        Topic("speed_command", optional.WheelSpeedCommand, JOINT_STATE),
        Topic("wheel_states", signals.WheelStates, JOINT_STATE),
        Topic("motor_states", signals.MotorStates, JOINT_STATE),
        Topic("imu", signals.InertialMeasurement, "sensor_msgs/msg/Imu"),
        Topic("twist", signals.BodyVelocity, "geometry_msgs/msg/TwistStamped"),
        Topic("pose", signals.BodyPose, "geometry_msgs/msg/PoseStamped", frame="odom"),
        Topic("battery", signals.BatteryCondition, "sensor_msgs/msg/BatteryState"),
        Topic("tire_forces", signals.TireForces, JOINT_STATE),
        Topic("imu/roll", optional.BodyRoll, "sensor_msgs/msg/Imu"),
        Topic("motor_electrics", optional.MotorElectrics, JOINT_STATE),
        Topic("motor_temperatures", optional.MotorTemperatures, JOINT_STATE),
        Topic("battery/cell", optional.CellCondition, "sensor_msgs/msg/BatteryState"),
        Topic("rear_steering/state", optional.RearSteeringState, JOINT_STATE),
        Topic("bench/load_command", optional.LoadCommand, JOINT_STATE),
        Topic("bench/shafts", optional.BenchShafts, JOINT_STATE),
        Topic("bench/electrical", optional.BenchElectrical, JOINT_STATE),
        Topic("bench/temperatures", optional.BenchTemperatures, JOINT_STATE),
        Topic("bench/energy", optional.BenchEnergy, JOINT_STATE),
        Topic("bench/coolant", optional.BenchCoolant, JOINT_STATE),
        Topic("bench/battery_coolant", optional.BatteryCoolant, JOINT_STATE),
        Topic("can/set_points", optional.SetPointFrames, JOINT_STATE),
        Topic("can/feedback", optional.FeedbackFrames, JOINT_STATE),
        Topic("can/bus", optional.BusStates, JOINT_STATE),
        Topic("recorder/progress", signals.RecorderProgress, "std_msgs/msg/Header", frame=""),
    )
}
