"""The controller's end of the CAN bus: set-points out, feedback in, drives led through their states."""
