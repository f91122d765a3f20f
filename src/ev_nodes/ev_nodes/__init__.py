"""ROS around a step: nodes, the master of time, the compiled loop."""
