"""Stepping the graph, without ROS: methods, their objects, the order in which they speak, the run."""
