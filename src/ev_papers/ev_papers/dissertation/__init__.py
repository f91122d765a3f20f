"""The dissertation: traction control, five torque control methods, and a test bench."""
