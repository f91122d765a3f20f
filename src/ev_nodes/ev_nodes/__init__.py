"""What is ROS about stepping: nodes, the master of time, the compiled loop."""
