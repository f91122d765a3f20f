"""Your own ASR in place of the built-in one: limit the drive torque of every wheel and copy the stamp."""

from contextlib import suppress

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class OwnAsr(Node):
    """Answers torque_request with torque_command."""

    def __init__(self):
        super().__init__("asr")
        self.limit = self.declare_parameter("limit", 1000.0).value  # N m
        self.command = self.create_publisher(JointState, "torque_command", 256)
        self.create_subscription(JointState, "torque_request", self.answer, 256)

    def answer(self, torque):
        for i, name in enumerate(torque.name):
            if not name.endswith("_brake"):
                torque.effort[i] = min(torque.effort[i], self.limit)
        self.command.publish(torque)  # the message that came, so with its stamp


rclpy.init()
with suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(OwnAsr())
