"""Nodes: what is ROS about stepping, in pieces of one idea each."""
