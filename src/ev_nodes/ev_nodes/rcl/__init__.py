"""What is done below rclpy, in the C library of ROS."""
