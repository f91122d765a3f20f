"""Stepping the graph, without ROS: methods, their objects, the order of their outputs, the run."""
