"""Views of a running car for RViz and Foxglove: tf, odometry, markers of tyre forces."""

from __future__ import annotations

import os
import time

import rclpy
from rclpy.signals import SignalHandlerOptions

from ev_doors.dashboard.controls import Controls
from ev_doors.dashboard.live_frames import LiveFrames
from ev_doors.dashboard.ros_views import RosViews
from ev_msgs_py.refusal import ParameterError
from ev_nodes.run_role import NO_LOG_FILE, OF_ROS, leave_graph, one_line
from ev_nodes.stepping.ros_domain import given_domain
from ev_nodes.stepping.stop_request import StopRequest
from ev_stack.command_line.refusal import refuse
from ev_stack.views.messages import CarViews

_VISUALIZATION = "visualization"  # in the graph
_VIEW_PERIOD = 0.05  # s of wall time between two looks


def visualize(argv: list[str]) -> None:
    """ev-stack visualization [--ros-args ...], of namespace /ev unless -r __ns:=/NAME is given."""
    with StopRequest() as stop:
        try:
            words, domain = [*argv, "--ros-args", NO_LOG_FILE], given_domain(os.environ)
            rclpy.init(args=words, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        except (ParameterError, *OF_ROS) as error:
            refuse(one_line(error))
        try:
            node = rclpy.create_node(_VISUALIZATION, namespace="ev", start_parameter_services=False)
            frames = LiveFrames(
                node, lambda cause, text: node.get_logger().warning(text, once=True)
            )
            views = RosViews(node, node.get_logger().warning)
            controls = Controls(
                node.context, node.get_namespace(), f"{_VISUALIZATION}_controls", frames.take_car
            )
            was_there = False
            # Waits for a master that has yet to come, and ends when the one that was there has
            # left.
            while not stop.received and (controls.has_master or not was_there):
                was_there |= controls.has_master
                controls.look()
                if frames.look() and frames.vehicle is not None:
                    rear_is_steered = "rear_steering" in controls.nodes
                    views.publish(
                        frames.recording,
                        CarViews(node.get_namespace(), frames.vehicle, rear_is_steered),
                    )
                time.sleep(_VIEW_PERIOD)
            leave_graph(node)
        finally:
            rclpy.try_shutdown()
    print(f"{_VISUALIZATION}: stopped" if stop.received else f"{_VISUALIZATION}: the run has ended")
