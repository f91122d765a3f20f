"""ev-stack visualization: /tf, odometry, markers of tyre forces and the car beside a run, for RViz and Foxglove."""

from __future__ import annotations

import sys
import time

import rclpy
from rclpy.signals import SignalHandlerOptions

from ev_core.nodes.stop_request import StopRequest
from ev_sim.dashboard.controls import Controls
from ev_sim.dashboard.live_frames import LiveFrames
from ev_sim.dashboard.ros_views import RosViews

_NAME = "visualization"  # in the graph
_PERIOD = 0.05  # s of wall time between two looks


def main(argv: list[str] | None = None) -> None:
    """ev-stack visualization [--ros-args ...]; the namespace is /ev unless -r __ns:=/NAME gives another one."""
    words = sys.argv[1:] if argv is None else argv
    with StopRequest() as stop:
        rclpy.init(args=words, signal_handler_options=SignalHandlerOptions.NO)
        try:
            node = rclpy.create_node(_NAME, namespace="ev", start_parameter_services=False)
            frames = LiveFrames(node, lambda cause, text: node.get_logger().warning(text, once=True))
            views = RosViews(node, node.get_logger().warning)
            controls = Controls(node.context, node.get_namespace(), f"{_NAME}_controls", frames.take_car)
            was_there = False
            while not stop.received and (controls.has_master or not was_there):
                was_there |= controls.has_master
                controls.look()
                if frames.look() and frames.vehicle is not None:
                    views.publish(frames.time, frames.values, frames.vehicle)
                time.sleep(_PERIOD)
        finally:
            rclpy.try_shutdown()
    print(f"{_NAME}: stopped" if stop.received else f"{_NAME}: the run has ended")
