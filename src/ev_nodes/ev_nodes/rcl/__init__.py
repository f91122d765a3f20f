"""Calls below rclpy, in the C library of ROS."""
