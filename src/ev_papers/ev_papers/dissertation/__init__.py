"""The dissertation: traction control, five torque control methods in an urban cycle, and a test bench."""
